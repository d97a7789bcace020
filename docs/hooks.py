"""What MkDocs does not do by itself: pages of examples and modules, equations without scripts, and a look at the links.

With DEBOND_SITE_RUN=0 in the environment the examples are shown and not run.
"""

from __future__ import annotations

import ast
import html
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from latex2mathml.converter import convert
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files

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
    "solve_in_python",
    "check_in_python",
)
EQUATION = re.compile(r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>', re.DOTALL)


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Entries of the navigation for the pages that are made."""
    for entry in config.nav:
        if "Examples" in entry:
            entry["Examples"] = [f"examples/{name}.md" for name in ORDER]
        if "Modules" in entry:
            entry["Modules"] = ["modules/index.md"] + [
                {package: [{name: f"modules/{package}.{name}.md"} for name in modules(package)]}
                for package in packages()
            ]
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """The pages that are made, and the scripts themselves to be taken along."""
    known = {script.stem for script in EXAMPLES.glob("*.py")}
    if known != set(ORDER):
        raise PluginError(f"examples without a place in ORDER, or the other way round: {sorted(known ^ set(ORDER))}")
    for name in ORDER:
        script = EXAMPLES / f"{name}.py"
        files.append(File.generated(config, f"examples/{script.name}", abs_src_path=str(script)))
        for made, content in example(script).items():
            files.append(File.generated(config, f"examples/{made}", content=content))
    files.append(File.generated(config, "modules/index.md", content=contents()))
    for package in packages():
        for name in modules(package):
            content = f"::: {package}.{name}\n"
            files.append(File.generated(config, f"modules/{package}.{name}.md", content=content))
    return files


def on_page_content(text: str, **_: object) -> str:
    """Equations in MathML, which a browser draws by itself."""

    def drawn(found: re.Match) -> str:
        return convert(html.unescape(found[3]).strip(), display="block" if found[2] == "[" else "inline")

    return EQUATION.sub(drawn, text)


def on_post_build(config: MkDocsConfig) -> None:
    """No page leads nowhere, and none fetches anything from elsewhere."""
    wrong = links.wrong(Path(config.site_dir))
    if wrong:
        raise PluginError("\n".join(wrong))


def example(script: Path) -> dict[str, str | bytes]:
    """The page of an example and its pictures, by their names."""
    if os.environ.get("DEBOND_SITE_RUN") == "0":
        shown = [(cell, cells.Output()) for cell in cells.split(script.read_text(encoding="utf-8"))]
        return {f"{script.stem}.md": cells.page(script, shown)}
    environment = {**os.environ, "PYTHONPATH": str(PROJECT), "OMP_NUM_THREADS": "1"}
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, str(HERE / "cells.py"), str(script), folder]
        run = subprocess.run(command, capture_output=True, text=True, env=environment)
        if run.returncode != 0:
            raise PluginError(f"{script.name} fails:\n{run.stderr}")
        made = {path.name: path.read_bytes() for path in sorted(Path(folder).iterdir())}
    return {name: content.decode() if name.endswith(".md") else content for name, content in made.items()}


def packages() -> list[str]:
    """Packages of the product with modules of their own, dotted."""
    folders = {path.parent for name in ("iga", "verify", "fem_reference") for path in (PROJECT / name).rglob("*.py")}
    dotted = sorted(".".join(folder.relative_to(PROJECT).parts) for folder in folders)
    return [package for package in dotted if modules(package)]


def modules(package: str) -> list[str]:
    """Public modules of a package, without those of the packages inside."""
    folder = PROJECT.joinpath(*package.split("."))
    return sorted(path.stem for path in folder.glob("*.py") if not path.stem.startswith("_"))


def contents() -> str:
    """All modules with the first sentence of their docstrings."""
    parts = ["# Modules", "What each file is about, in its own words."]
    for package in packages():
        parts += [f"## {package}", about(package, "__init__")]
        rows = [f"| [`{name}`]({package}.{name}.md) | {about(package, name)} |" for name in modules(package)]
        parts.append("\n".join(["| module | |", "|---|---|", *rows]))
    return "\n\n".join(parts) + "\n"


def about(package: str, name: str) -> str:
    """First paragraph of a module's docstring, as the cell of a table."""
    file = PROJECT.joinpath(*package.split("."), f"{name}.py")
    text = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].split()).replace("|", "\\|")
