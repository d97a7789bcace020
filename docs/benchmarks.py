"""A page a packaged scene: drawing, numbers, published values, the curve of a beam, and the input for Abaqus.

python benchmarks.py FOLDER     writes NAME.md and NAME.inp of every scene, with DEBOND_SITE_RUN=0 without curves
"""

from __future__ import annotations

import os
import sys
import tempfile
from functools import partial
from pathlib import Path

from iga.notebook import Drawn, chart
from verify.command_line.scenes.listing import page as listed
from verify.export.command import export
from verify.methods.method import Unsuitable
from verify.methods.solve import solve
from verify.scene.load import load_scene, packaged_scenes
from verify.scene.schema import Scene
from verify.support.at_once import at_once
from verify.support.refusal import NotRun, Refusal

SCENES = Path(__file__).resolve().parent.parent / "verify" / "scene" / "scenes"


def page(name: str, folder: Path, run: bool) -> str:
    """The page in Markdown; the input of Abaqus goes into the folder where the law can be written down."""
    scene = load_scene(name)
    lines = (SCENES / f"{name}.toml").read_text(encoding="utf-8").splitlines()
    about = " ".join(line.lstrip("# ") for line in lines[: next(i for i, x in enumerate(lines) if x[:1] != "#")])
    parts = [f"# {name}", about, f"```text\n{listed(scene, 100)}\n```", *published(scene)]
    parts += curve(scene) if run else []
    parts += ["## Run it", f"    ./debond verify {name}\n    ./debond verify {name} --with mycode.csv"]
    lower = {"degree": 2} if scene.dolfinx.degree in (3, 4) else {}
    asked, sets = scene.dolfinx.model_copy(update=lower), " --set dolfinx.degree=2" * bool(lower)
    with tempfile.TemporaryDirectory() as elsewhere:
        try:
            export(scene, "abaqus", Path(elsewhere), asked)
            (folder / f"{name}.inp").write_bytes((Path(elsewhere) / f"{name}.inp").read_bytes())
            how = f"debond export {name} --format abaqus{sets}"
            parts.append(f"The same for Abaqus, as `{how}` writes it: [{name}.inp]({name}.inp).")
        except Refusal as why:
            parts.append(f"There is no input for Abaqus: {why}.")
    return "\n\n".join(filter(None, parts)) + "\n"


def published(scene: Scene) -> list[str]:
    """A table of the values that others published; nothing where there is none."""
    rows = [
        f"| {one.quantity} | {'' if one.opening is None else f'{one.opening:g}'} "
        f"| {' to '.join(f'{value:.5g}' for value in dict.fromkeys(one.value))} | {one.tolerance:.1%} | {one.source} |"
        for one in scene.published
    ]
    head = "| quantity | opening | value | tolerance | source |\n|---|---|---|---|---|"
    return ["## Published values", "\n".join([head, *rows])] if rows else []


def curve(scene: Scene) -> list[str]:
    """Load over opening by the cohesive beam; nothing where it cannot solve the scene."""
    try:
        run = solve(scene, "beam")
    except (NotRun, Unsuitable, ValueError):
        return []
    peak = int(run.load.argmax())
    told = f"By the beam on a cohesive interface, which is quick and no reference: peak load {run.load[peak]:.4g} at "
    return ["## Load over opening", chart([Drawn("beam", run.opening, run.load)]), f"{told}{run.opening[peak]:.4g}."]


def _written(name: str, folder: Path, run: bool) -> None:
    (folder / f"{name}.md").write_text(page(name, folder, run), encoding="utf-8")


if __name__ == "__main__":
    into = Path(sys.argv[1])
    into.mkdir()
    list(at_once(partial(_written, folder=into, run=os.environ.get("DEBOND_SITE_RUN") != "0"), packaged_scenes()))
