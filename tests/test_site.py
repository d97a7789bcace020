"""The teaching site: scripts become pages, links are looked at, and the whole of it can be built."""

import importlib.util
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from verify.cli import parser
from verify.methods.solve import solve

PROJECT = Path(__file__).parents[1]
SITE = PROJECT / "docs"


def loaded(name: str):
    """A module of the site, which is no package."""
    spec = importlib.util.spec_from_file_location(f"site_{name}", SITE / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # frozen dataclasses look themselves up
    spec.loader.exec_module(module)
    return module


cells, links = loaded("cells"), loaded("links")

SCRIPT = """# %% [markdown]
# # Title
#
# Text with $x$.

# %%
x = 2

# %%
print(x + 1)
figure = __import__("matplotlib.pyplot").pyplot.figure()
"""


def test_cells_are_told_apart():
    title, first, second = cells.split(SCRIPT)
    assert title.prose and title.text == "# Title\n\nText with $x$."
    assert (first.text, first.prose, first.line) == ("x = 2", False, 7)
    assert second.line == 10 and SCRIPT.splitlines()[second.line - 1] == second.text.splitlines()[0]


def test_the_notebook_is_its_script_and_runs_in_a_notebook(tmp_path, monkeypatch):
    """Linear fracture mechanics stands in for every solver; what is asserted at the end is that of the script."""
    script = PROJECT / "examples" / "oscillation.py"
    text = script.with_suffix(".ipynb").read_text(encoding="utf-8")
    assert text == cells.notebook(script.read_text(encoding="utf-8")), "python docs/cells.py examples/oscillation.ipynb"
    *code, last = ("".join(one["source"]) for one in json.loads(text)["cells"] if one["cell_type"] == "code")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("verify.methods.solve.solve", lambda scene, method, solve=solve: solve(scene, "lefm"))
    pytest.importorskip("matplotlib").use("Agg")
    names = {"__name__": "__main__"}
    for one in code:
        exec(one, names)
    assert "assert" in last and (tmp_path / "oscillation.png").stat().st_size > 10_000


def test_a_page_of_a_scene_has_drawing_values_curve_and_input(tmp_path):
    page = loaded("benchmarks").page
    made = page("compdam-dcb", tmp_path, False) + page("dcb-czm1-linear", tmp_path, True)
    for part in ("3.8 thick", "## Published values", "<polyline", "peak load 0.5", "(compdam-dcb.inp)"):
        assert part in made, part
    assert "(peel-60.inp)" in page("peel-60", tmp_path, False)
    assert "*COHESIVE SECTION" in (tmp_path / "compdam-dcb.inp").read_text().upper()


def test_letters_of_equations_are_in_every_font():
    """Slanted by the style: browsers take a letter of Unicode's for one in <mi>, a box where there is no such font."""
    pytest.importorskip("latex2mathml")
    build = loaded("build")
    written = build.EQUATION.sub(build.drawn, '<span class="arithmatex">\\(E / (1 - \\nu^2)\\)</span>')
    assert written.count("<mi") == written.count('<mi mathvariant="normal" class="slanted">') == 2
    assert "mi.slanted" in (SITE / "pages" / "style.css").read_text()


@pytest.mark.parametrize("source", ["x = 1\n# %%\n", "# %% [raw]\nx\n", "# %% [markdown]\nx = 1\n"])
def test_what_is_no_page_is_refused(source):
    with pytest.raises(ValueError, match="cell|prose"):
        cells.split(source)


def test_a_page_has_what_its_script_prints_and_draws(tmp_path):
    pytest.importorskip("matplotlib")
    script = tmp_path / "small.py"
    script.write_text(SCRIPT)
    done = cells.run(script, tmp_path)
    page = cells.page(script, done)
    assert "```python\nx = 2\n```" in page and "```text\n3\n```" in page
    (picture,) = done[-1][1].pictures
    assert f"({picture})" in page and (tmp_path / picture).stat().st_size > 1000


def test_an_assertion_that_fails_is_told_with_its_line(tmp_path):
    script = tmp_path / "wrong.py"
    script.write_text("# %%\nx = 1\n\n# %%\nassert x > 2\n")
    command = [sys.executable, SITE / "cells.py", script, tmp_path]
    run = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": str(PROJECT)})
    assert run.returncode != 0 and "wrong.py" in run.stderr and "line 5" in run.stderr


def pages(folder: Path, **bodies: str) -> list[str]:
    """What is wrong with pages of these bodies."""
    for name, body in bodies.items():
        (folder / f"{name}.html").write_text(f"<html><body>{body}</body></html>")
    return links.wrong(folder)


def test_links_that_lead_somewhere_are_fine(tmp_path):
    (tmp_path / "style.css").write_text("a { background: url('data:image/png;base64,x') }")
    one = '<link rel="stylesheet" href="style.css"><a href="two.html#there">x</a> <a href="https://example.org">y</a>'
    assert pages(tmp_path, one=one, two='<h1 id="there">t</h1><a href="#there">z</a>') == []


@pytest.mark.parametrize(
    ("body", "complaint"),
    [
        ('<a href="three.html">x</a>', "three.html leads nowhere"),
        ('<a href="#nowhere">x</a>', "#nowhere has no such place"),
        ('<img src="https://example.org/x.png">', "fetches https://example.org/x.png"),
        ('<script src="//example.org/x.js"></script>', "fetches //example.org/x.js"),
        ('<link rel="stylesheet" href="https://example.org/x.css">', "fetches https://example.org/x.css"),
    ],
)
def test_a_bad_link_is_found(tmp_path, body, complaint):
    assert pages(tmp_path, one=body) == [f"one.html: {complaint}"]


def test_a_style_that_fetches_is_found(tmp_path):
    (tmp_path / "style.css").write_text('@import "https://example.org/font.css";')
    assert pages(tmp_path, one="") == ["style.css: fetches from elsewhere"]


def test_nothing_is_no_site(tmp_path):
    assert links.wrong(tmp_path) == [f"{tmp_path}: has no pages"]


WRITTEN = [PROJECT / "README.md", *sorted((SITE / "pages").rglob("*.md"))]


@pytest.mark.parametrize("page", WRITTEN, ids=lambda page: page.relative_to(PROJECT).as_posix())
def test_links_lead_somewhere(page):
    """To files, in the guide to headings by their names, and to examples and modules that become pages."""
    for target in re.findall(r"\]\((?!https?:)([^)\s]+)\)", page.read_text()):
        path, _, place = target.partition("#")
        file = page.parent / path if path else page
        if file.parent.name == "examples" and file.suffix == ".md":
            file = PROJECT / "examples" / f"{file.stem}.py"
        elif file.parent.name == "modules":
            file = (PROJECT / file.stem.replace(".", "/")).with_suffix(".py")
        assert file.exists(), target
        headings = re.findall(r"^#+ (.+)$", file.read_text(), re.MULTILINE) if place else []
        names = [re.sub(r"[^\w -]", "", text).lower().replace(" ", "-") for text in headings]
        assert not place or place in names, target


def test_commands_of_the_guide_are_taken():
    """Every command with its options in the README and in the guide."""
    written = [PROJECT / "README.md", *sorted((SITE / "pages" / "guide").glob("*.md"))]
    text = "\n".join(page.read_text() for page in written).replace("\\\n", " ")
    lines = re.findall(r"(?:^ {4}|`)\./debond ((?!exec|test)[^`#>\n]+)", text, re.MULTILINE)
    assert len(lines) > 30
    for line in lines:
        assert line.strip() == "compare A B" or parser().parse_args(shlex.split(line)).command, line


def maker():
    """The program that builds the site, where its libraries are."""
    for package in ("zensical", "mkdocstrings", "latex2mathml", "matplotlib"):
        pytest.importorskip(package)
    return loaded("build")


@pytest.fixture
def small(tmp_path, monkeypatch):
    """Builds a site of one page and one example in tmp_path / "site"; what is wrong with it."""
    build = maker()
    (tmp_path / "examples").mkdir()
    replaced = {"HERE": tmp_path, "PROJECT": tmp_path, "EXAMPLES": tmp_path / "examples", "ORDER": ("one",)}
    for name, value in replaced.items():
        monkeypatch.setattr(build, name, value)
    nav = 'nav = [{ "Home" = "index.md" }, { "Examples" = [] }, { "Modules" = [] }]'
    settings = re.sub(r"^nav = \[.*?^\]", nav, (SITE / "zensical.toml").read_text(), flags=re.DOTALL | re.MULTILINE)
    (tmp_path / "zensical.toml").write_text(settings)
    shutil.copytree(SITE / "pages", tmp_path / "pages", ignore=lambda *_: {"guide", "theory", "glossary.md"})

    def built(page: str, script: str = "# %%\nx = 1\n", **others: str) -> list[str]:
        for name, text in {"index": page, **others}.items():
            (tmp_path / "pages" / f"{name}.md").write_text(text)
        (tmp_path / "examples" / "one.py").write_text(script)
        return build.build(tmp_path / "site")

    return built


def test_equations_are_drawn_and_examples_run(small, tmp_path):
    assert small("# Title\n\n$x < 1$ by [one](examples/one.md)\n\n$$\ny\n$$\n", "# %%\nprint(6 * 7)\n") == []
    page = (tmp_path / "site" / "index.html").read_text()
    assert page.count("<math") == 2 and "&#x0003C;" in page and "arithmatex" not in page
    assert "42" in (tmp_path / "site" / "examples" / "one.html").read_text()


@pytest.mark.parametrize(
    ("given", "complaint"),
    [
        ({"page": "[x](nowhere.md) and [y](#elsewhere)"}, "nowhere.md.*#elsewhere"),
        ({"page": "![x](https://example.org/x.png)"}, "index.html: fetches https://example.org/x.png"),
        ({"page": "x", "other": "x"}, "other.md: in the navigation or among the pages, not in both"),
        ({"page": "x", "script": "# %%\nassert 1 > 2\n"}, "one.py fails"),
    ],
)
def test_a_site_with_a_fault_is_told(small, given, complaint):
    wrong = small(**given)
    assert len(wrong) == 1 and re.search(complaint, wrong[0], re.DOTALL), wrong


def test_a_folder_of_something_else_is_kept(small, tmp_path):
    (tmp_path / "site").mkdir()
    (tmp_path / "site" / "thesis").touch()
    assert small("x") == [f"{tmp_path / 'site'}: is there, and is no site that could be replaced"]
    assert (tmp_path / "site" / "thesis").exists()


@pytest.mark.slow
@pytest.mark.parametrize("run", [False, True])
def test_the_whole_site_is_built_and_has_no_bad_link(tmp_path, run):
    maker()
    site = tmp_path / "site"
    environment = {**os.environ, "DEBOND_SITE_RUN": str(int(run))}
    done = subprocess.run([sys.executable, SITE / "build.py", site], capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "<math" in (site / "theory" / "law.html").read_text()
    assert "bezier_extraction" in (site / "modules" / "iga.bases.bspline.html").read_text()
    page = (site / "examples" / "bezier_extraction.html").read_text()
    assert not run or ("13 Bezier points from 7 control points" in page and "bezier_extraction-1.png" in page)
    browsed(site, tmp_path / "profile")


HEIGHT = "document.querySelector('math').getBoundingClientRect().height"
ECHO = """new Promise((done) => {
  const worker = new Worker("../echo.js");
  worker.onmessage = (answer) => done(answer.data);
  worker.postMessage(1);
})"""


def browsed(site: Path, profile: Path) -> None:
    """A browser, where there is one, asks for nothing but files and has nothing to complain about."""
    from browser import Browser, found

    if found() is None:
        return
    with Browser(found(), profile) as browser:
        for page in (site / name for name in ("index.html", "theory/law.html", "examples/snap_back.html")):
            browser.open(page)
            assert browser.complaints == [] and all(asked.startswith(("file:", "data:")) for asked in browser.requests)
            assert page.parent.name != "theory" or browser.ask(HEIGHT) > 10
        (site / "echo.js").write_text("self.onmessage = (asked) => self.postMessage(asked.data + 1)")
        assert browser.ask(ECHO) == 2  # no browser would start the worker of the search from the disk
