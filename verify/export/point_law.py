"""The paths of `debond law` as files, with input for codes that need more than a table."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from verify.export.one_element import abaqus_lines, collector
from verify.studies.law.paths import JumpPath
from verify.studies.law.read import PATHS_FILE, lines
from verify.theory.mixed_law import MixedBond

#: Files of a deck for Abaqus, of the script that reads its results, of a block for MOOSE, of the notes.
DECK, COLLECTOR, MOOSE_BLOCK, GUIDE = "paths.inp", "abaqus_to_csv.py", "moose.i", "README.txt"


def write_paths(bond: MixedBond, ways: Sequence[JumpPath], scene: str, folder: Path) -> list[Path]:
    """Write all files into a folder that is there.

    Parameters
    ----------
    scene : name of the scene, which the commands in the notes take
    """
    columns = folder / "columns"
    columns.mkdir(exist_ok=True)
    made: dict[Path, Iterator[str]] = {
        folder / PATHS_FILE: lines(ways),
        folder / DECK: abaqus_lines(bond, ways, scene),
        folder / COLLECTOR: collector(ways),
        folder / MOOSE_BLOCK: _moose(ways),
        folder / GUIDE: _notes(bond, ways, scene),
        **{columns / f"{way.name}.csv": _columns(way) for way in ways},
    }
    for path, content in made.items():
        path.write_text("\n".join(content) + "\n", encoding="utf-8")
    return [path for path in made if path.parent == folder]


def _columns(way: JumpPath) -> Iterator[str]:
    """One path over a time of one unit a step, as MOOSE and others read it."""
    yield "time,g,s"
    yield from (f"{i},{g!r},{s!r}" for i, (g, s) in enumerate(zip(way.g.tolist(), way.s.tolist(), strict=True)))


def _moose(ways: Sequence[JumpPath]) -> Iterator[str]:
    """Functions of time that move the upper face; one path is one run."""
    way = ways[0]
    yield f"# Path {way.name}: of another one, change both file names and end_time to its number of steps less one."
    yield "# Two elements of height one, joined by the cohesive zone; the outer face of the lower one is held."
    yield "# Their stiffness must be 1e6 times that of the bond, or their deformation is taken for the jump."
    yield "[Functions]"
    for key, number in (("g", 1), ("s", 2)):
        yield f"  [{key}]"
        yield "    type = PiecewiseLinear"
        yield f"    data_file = columns/{way.name}.csv"
        yield "    format = columns"
        yield "    x_index_in_file = 0"
        yield f"    y_index_in_file = {number}"
        yield "  []"
    yield "[]"
    yield "[Executioner]"
    yield "  type = Transient"
    yield "  dt = 1"
    yield f"  end_time = {way.g.size - 1}"
    yield "[]"


def _notes(bond: MixedBond, ways: Sequence[JumpPath], scene: str) -> Iterator[str]:
    steps = sum(way.g.size for way in ways)
    yield f"Displacement paths for one point of the bond of {scene}: {len(ways)} paths, {steps} steps."
    yield ""
    yield f"{PATHS_FILE}   path,step,g,s: opening g and slip s of every step; each path begins undamaged at step 0"
    yield "columns/    the same, a file a path: time,g,s"
    yield f"{DECK}   one COH2D4 a path for Abaqus/Standard, moved by amplitudes"
    yield f"{COLLECTOR}   abaqus python {COLLECTOR} paths.odb: writes tractions.csv"
    yield f"{MOOSE_BLOCK}     functions for MOOSE, which read columns/"
    yield ""
    yield "Follow each path step by step, with the history of the step before, and write a table with the columns"
    yield "    path,step,g,s,p,t"
    yield "p the normal traction, positive in tension, t the shear traction. The tangent is judged if there are also"
    yield "    dp_dg,dp_ds,dt_dg,dt_ds"
    yield f"Then: debond law {scene} --with tractions.csv --out verdict"
    yield "Other names and units: --columns p=S22,t=S12 --scales p=1e-6"
    yield ""
    yield "The bond:"
    for key, told in _TOLD.items():
        yield f"    {key}: {told(bond)}"


def _pair(values: Sequence[float]) -> str:
    return f"{values[0]:.12g} in opening, {values[1]:.12g} in sliding"


_TOLD: dict[str, Callable[[MixedBond], str]] = {
    "law": lambda bond: bond.law,
    "strength": lambda bond: _pair(bond.strength),
    "toughness": lambda bond: _pair(bond.toughness),
    "stiffness": lambda bond: _pair(bond.slopes),
    "penalty on closing": lambda bond: f"{bond.penalty:.12g}" if bond.contact else "none, the stiffness of opening",
    "criterion": lambda bond: f"{bond.criterion}, exponent {bond.exponent:g}, onset {bond.onset_rule}",
    "friction": lambda bond: f"{bond.friction:g}",
    "viscosity, in parts of the duration of a path": lambda bond: f"{bond.viscosity:g}",
    "shear strength gained per pressure": lambda bond: f"{bond.pressure_strength:g}",
}
