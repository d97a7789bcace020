"""The documentation as a site that is read from the disk.

python docs/build.py [FOLDER]     writes it to FOLDER, out/site without one; exit code 1 says what is wrong

With DEBOND_SITE_RUN=0 in the environment the examples are shown and not run.
"""

from __future__ import annotations

import ast
import html
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from latex2mathml.converter import convert

HERE = Path(__file__).resolve().parent
PROJECT, EXAMPLES = HERE.parent, HERE.parent / "examples"
sys.path.insert(0, str(HERE))

import cells  # noqa: E402
import links  # noqa: E402

#: The examples in the order in which a newcomer reads them.
ORDER = (
    "first_comparison",
    "process_zone",
    "oscillation",
    "snap_back",
    "j_integral",
    "bezier_extraction",
    "t_junctions",
    "verify_your_own_code",
    "what_a_law_owes_you",
    "data_reduction",
    "what_accuracy_costs",
    "paper",
    "solve_in_python",
    "check_in_python",
)
#: Page -> the example whose picture shows what it is about, and what is seen.
PICTURES = {
    "index": ("first_comparison", "a double cantilever beam by two codes and two theories, and the stress in its arms"),
    "guide/python": ("solve_in_python", "three bases on one scene, and the bond at one point against its law"),
    "guide/curves": ("check_in_python", "the curve of another code, and two that judge it"),
    "guide/own_code": ("verify_your_own_code", "a code of your own, right and with two defects"),
    "guide/law": ("what_a_law_owes_you", "a law that takes too much work to fail, and the defect that explains it"),
    "guide/reduce": (
        "data_reduction",
        "R-curves by each scheme, and how far they are off where the process zone is long",
    ),
    "guide/cost": ("what_accuracy_costs", "error of the curve against unknowns and against time"),
    "guide/methods": ("t_junctions", "few unknowns by four methods; adaptive T-splines follow the crack"),
    "guide/own_meshes": ("oscillation", "elements longer than the process zone: the load oscillates"),
    "theory/path": ("snap_back", "a path that snaps back at every element, and what a test would show of it"),
    "theory/extraction": (
        "bezier_extraction",
        "the splines of an element, and the Bernstein polynomials that they are made of",
    ),
    "theory/j_integral": ("j_integral", "J by several routes, and what is left between two of them on four meshes"),
    "theory/interface": ("process_zone", "what few elements in the process zone do to the curve"),
}
EQUATION = re.compile(r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>', re.DOTALL)
COLOUR = re.compile("\x1b\\[[0-9;]*m")
#: Of the examples, and of mkdocstrings, which finds the modules by it.
ENVIRONMENT = {
    **os.environ,
    "PYTHONPATH": os.pathsep.join([str(PROJECT), str(PROJECT / "verify" / "front")]),
    "OMP_NUM_THREADS": "1",
}


def build(site: Path) -> list[str]:
    """Build the site; one sentence for everything that is wrong."""
    if site.exists() and not (site / "sitemap.xml").exists():
        return [f"{site}: is there, and is no site that could be replaced"]
    with tempfile.TemporaryDirectory() as temporary:
        work = Path(temporary)
        shutil.copytree(HERE / "pages", work / "pages")
        wrong = examples(work / "pages" / "examples") + benchmarks(work / "pages" / "benchmarks")
        illustrate(work / "pages")
        write_modules(work / "pages" / "modules")
        config = configuration()
        (work / "zensical.toml").write_text(config, encoding="utf-8")
        wrong = wrong or not_in_navigation(work / "pages", config)
        if wrong:
            return wrong
        command = [sys.executable, "-m", "zensical", "build", "--strict"]
        run = subprocess.run(command, cwd=work, env=ENVIRONMENT, capture_output=True, text=True)
        if run.returncode != 0:
            return [f"zensical ends with {run.returncode}:\n" + COLOUR.sub("", run.stdout + run.stderr)]
        for page in (work / "site").rglob("*.html"):
            page.write_text(EQUATION.sub(drawn, page.read_text(encoding="utf-8")), encoding="utf-8")
        shutil.rmtree(site, ignore_errors=True)
        shutil.copytree(work / "site", site)
    return links.wrong(site)


def drawn(found: re.Match) -> str:
    """An equation in MathML, which a browser draws by itself.

    Letters are plain ones that the style slants: the slanted ones of Unicode, which a browser takes for ``<mi>`` of one
    letter, are in few fonts but those for mathematics.
    """
    written = convert(html.unescape(found[3]).strip(), display="block" if found[2] == "[" else "inline")
    return re.sub(r"<mi>(\w|&#x[0-9A-F]+;)</mi>", r'<mi mathvariant="normal" class="slanted">\1</mi>', written)


def configuration() -> str:
    """What Zensical reads: zensical.toml with the navigation of the pages that are made."""
    packages = [
        {package: [{name: f"modules/{package}.{name}.md"} for name in files]} for package, files in modules().items()
    ]
    made = {
        "Examples": [f"examples/{name}.md" for name in ORDER],
        "Scenes": [f"benchmarks/{name}.md" for name in scenes()],
        "Modules": ["modules/index.md", *packages],
    }
    text = (HERE / "zensical.toml").read_text(encoding="utf-8")
    for title, entries in made.items():
        text = text.replace(f'"{title}" = []', f'"{title}" = ' + json.dumps(entries, separators=(", ", " = ")))
    return text


def not_in_navigation(pages: Path, config: str) -> list[str]:
    """Pages to which the navigation does not lead, and the other way round."""
    there = {path.relative_to(pages).as_posix() for path in pages.rglob("*.md")}
    listed = set(re.findall(r'"([^"]+\.md)"', config))
    return [f"{page}: in the navigation or among the pages, not in both" for page in sorted(there ^ listed)]


def examples(folder: Path) -> list[str]:
    """Write the pages of the examples, with their pictures and the scripts themselves."""
    folder.mkdir()
    wrong = []
    for script in sorted(EXAMPLES.glob("*.py")):
        shutil.copy(script, folder)
        if os.environ.get("DEBOND_SITE_RUN") == "0":
            shown = [(cell, cells.Output()) for cell in cells.split(script.read_text(encoding="utf-8"))]
            (folder / f"{script.stem}.md").write_text(cells.page(script, shown), encoding="utf-8")
            continue
        command = [sys.executable, cells.__file__, str(script), str(folder)]
        run = subprocess.run(command, capture_output=True, text=True, env=ENVIRONMENT)
        if run.returncode != 0:
            wrong.append(f"{script.name} fails:\n{run.stderr}")
    return wrong


def illustrate(pages: Path) -> None:
    """Put `PICTURES` below the titles of their pages, where the examples were run."""
    for name, (example, seen) in PICTURES.items():
        page, drawn = pages / f"{name}.md", sorted((pages / "examples").glob(f"{example}-*.png"))
        if drawn:
            title, rest = page.read_text(encoding="utf-8").split("\n", 1)
            up = "../" * name.count("/")
            link = (
                f"[![{seen}]({up}examples/{drawn[0].name})]({up}examples/{example}.md)\n*{seen[0].upper() + seen[1:]}.*"
            )
            page.write_text(f"{title}\n\n{link}\n{rest}", encoding="utf-8")


def scenes() -> list[str]:
    """Names of the packaged scenes, where they have pages."""
    files = (PROJECT / "verify" / "scene" / "scenes").glob("*.toml")
    return sorted(file.stem for file in files)


def benchmarks(folder: Path) -> list[str]:
    """Write a page for each packaged scene."""
    if not scenes():
        return []
    command = [sys.executable, str(HERE / "benchmarks.py"), str(folder)]
    run = subprocess.run(command, capture_output=True, text=True, env=ENVIRONMENT)
    return [f"benchmarks.py fails:\n{run.stderr}"] if run.returncode != 0 else []


def write_modules(folder: Path) -> None:
    """Write a page for each module, filled by mkdocstrings, and their list."""
    folder.mkdir()
    (folder / "index.md").write_text(contents(), encoding="utf-8")
    for package, files in modules().items():
        for name in files:
            (folder / f"{package}.{name}.md").write_text(f"::: {package}.{name}\n", encoding="utf-8")


def modules() -> dict[str, dict[str, Path]]:
    """Public modules by their names, for every package of the product that has some, itself named with dots."""
    files = (file for name in ("iga", "verify", "fem_reference") for file in sorted((PROJECT / name).rglob("*.py")))
    found = {}
    for file in files:
        if not file.stem.startswith("_"):
            package = ".".join(file.parent.relative_to(PROJECT).parts).removeprefix("verify.front.")
            found.setdefault(package, {})[file.stem] = file
    return dict(sorted(found.items()))


def contents() -> str:
    """All modules with the first paragraphs of their docstrings."""
    parts = ["# Modules", "What each file is about, in its own words."]
    for package, files in modules().items():
        parts += [f"## {package}", about(next(iter(files.values())).with_name("__init__.py"))]
        rows = [f"| [`{name}`]({package}.{name}.md) | {about(file)} |" for name, file in files.items()]
        parts.append("\n".join(["| module | |", "|---|---|", *rows]))
    return "\n\n".join(parts) + "\n"


def about(file: Path) -> str:
    """First paragraph of a module's docstring, as the cell of a table."""
    text = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].split()).replace("|", "\\|")


if __name__ == "__main__":
    found = build(Path(sys.argv[1]) if len(sys.argv) > 1 else PROJECT / "out" / "site")
    print("\n".join(found) or "every link leads somewhere, nothing is fetched from elsewhere")
    raise SystemExit(bool(found))
