"""The paths of `debond law` as files, with input for codes that need more than a table."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from verify.export.one_element import abaqus_deck, collector
from verify.studies.law.paths import JumpPath
from verify.studies.law.read import PATHS_FILE, lines
from verify.theory.mixed_law import MixedBond

#: Files of a deck for Abaqus, of the script that reads its results, of a block for MOOSE, of the notes.
DECK, COLLECTOR, MOOSE_BLOCK, GUIDE = "paths.inp", "abaqus_to_csv.py", "moose.i", "README.txt"

#: Functions of time that move the upper face; one path is one run.
_MOOSE = """\
# Path {name}: of another one, change both file names and end_time to its number of steps less one.
# Two elements of height one, joined by the cohesive zone; the outer face of the lower one is held.
# Their stiffness must be 1e6 times that of the bond, or their deformation is taken for the jump.
[Functions]
  [g]
    type = PiecewiseLinear
    data_file = columns/{name}.csv
    format = columns
    x_index_in_file = 0
    y_index_in_file = 1
  []
  [s]
    type = PiecewiseLinear
    data_file = columns/{name}.csv
    format = columns
    x_index_in_file = 0
    y_index_in_file = 2
  []
[]
[Executioner]
  type = Transient
  dt = 1
  end_time = {last}
[]
"""

_PATH_NOTES = """\
Displacement paths for one point of the bond of {scene}: {count} paths, {steps} steps.

paths.csv   path,step,g,s: opening g and slip s of every step; each path begins undamaged at step 0
columns/    the same, a file a path: time,g,s
paths.inp   one COH2D4 a path for Abaqus/Standard, moved by amplitudes
abaqus_to_csv.py   abaqus python abaqus_to_csv.py paths.odb: writes tractions.csv
moose.i     functions for MOOSE, which read columns/

Follow each path step by step, with the history of the step before, and write a table with the columns
    path,step,g,s,p,t
p the normal traction, positive in tension, t the shear traction. The tangent is judged if there are also
    dp_dg,dp_ds,dt_dg,dt_ds
Then: debond law {scene} --with tractions.csv --out verdict
Other names and units: --columns p=S22,t=S12 --scales p=1e-6

The bond:
    law: {bond.law}
    strength: {bond.strength[0]:.12g} in opening, {bond.strength[1]:.12g} in sliding
    toughness: {bond.toughness[0]:.12g} in opening, {bond.toughness[1]:.12g} in sliding
    stiffness: {bond.slopes[0]:.12g} in opening, {bond.slopes[1]:.12g} in sliding
    penalty on closing: {penalty}
    criterion: {bond.criterion}, exponent {bond.exponent:g}, onset {bond.onset_rule}
    friction: {bond.friction:g}
    viscosity, in parts of the duration of a path: {bond.viscosity:g}
    shear strength gained per pressure: {bond.pressure_strength:g}
"""


def write_paths(bond: MixedBond, ways: Sequence[JumpPath], scene: str, folder: Path) -> list[Path]:
    """Write all files into a folder that is there.

    Parameters
    ----------
    scene : name of the scene, which the commands in the notes take
    """
    columns, steps = folder / "columns", [way.g.size for way in ways]
    columns.mkdir(exist_ok=True)
    penalty = f"{bond.penalty:.12g}" if bond.contact else "none, the stiffness of opening"
    made = {
        PATHS_FILE: "\n".join(lines(ways)) + "\n",
        DECK: abaqus_deck(bond, ways, scene),
        COLLECTOR: collector(ways),
        MOOSE_BLOCK: _MOOSE.format(name=ways[0].name, last=steps[0] - 1),
        GUIDE: _PATH_NOTES.format(scene=scene, count=len(ways), steps=sum(steps), bond=bond, penalty=penalty),
    }
    for name, content in made.items():
        (folder / name).write_text(content, encoding="utf-8")
    for way in ways:  # over a time of one unit a step, as MOOSE and others read it
        rows = enumerate(zip(way.g.tolist(), way.s.tolist(), strict=True))
        content = "time,g,s\n" + "".join(f"{i},{g!r},{s!r}\n" for i, (g, s) in rows)
        (columns / f"{way.name}.csv").write_text(content, encoding="utf-8")
    return [folder / name for name in made]
