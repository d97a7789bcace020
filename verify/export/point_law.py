"""The paths of `debond law` as files, with input for codes that need more than a table."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from verify.export.moose import NEWTON, block
from verify.studies.law.paths import JumpPath
from verify.studies.law.read import PATHS_FILE, lines
from verify.theory.mixed_law import MixedBond

#: Jumps below this part of the largest are written as 0: Abaqus does not read the smallest numbers of all.
SMALLEST = 1e-30
#: Pairs of time and amplitude in a line.
PAIRS_A_LINE = 4

#: Step i is at time i.
_DECK = """\
*HEADING
debond law {scene}: a cohesive element for each path
{notes}
{elements}
*COHESIVE SECTION, ELSET=bond, MATERIAL=bond, RESPONSE=TRACTION SEPARATION, THICKNESS=SPECIFIED
1., 1.
*MATERIAL, NAME=bond
*ELASTIC, TYPE=TRACTION
{K[0]:.12g}, {K[1]:.12g}, {K[1]:.12g}
*DAMAGE INITIATION, CRITERION=QUADS
{p[0]:.12g}, {p[1]:.12g}, {p[1]:.12g}
*DAMAGE EVOLUTION, TYPE=ENERGY, MIXED MODE BEHAVIOR={mixed}, POWER={exponent:.12g}
{G[0]:.12g}, {G[1]:.12g}, {G[1]:.12g}
{amplitudes}
*STEP, NAME=paths, NLGEOM=NO, INC=100000
*STATIC, DIRECT
1., {last}.
{boundaries}
*OUTPUT, FIELD, FREQUENCY=1
*ELEMENT OUTPUT, ELSET=bond
S, SDEG
*END STEP
"""

_ELEMENT = """\
** path {name}
*NODE, NSET=nodes{i}
{n[0]}, {x[0]:g}, 0.
{n[1]}, {x[1]:g}, 0.
{n[2]}, {x[1]:g}, 0.
{n[3]}, {x[0]:g}, 0.
*ELEMENT, TYPE=COH2D4, ELSET=bond
{i}, {n[0]}, {n[1]}, {n[2]}, {n[3]}
*NSET, NSET=lower{i}
{n[0]}, {n[1]}
*NSET, NSET=upper{i}
{n[2]}, {n[3]}"""

_BOUNDARY = """\
*BOUNDARY
lower{0}, 1, 2
*BOUNDARY, AMPLITUDE=s{0}
upper{0}, 1, 1, 1.
*BOUNDARY, AMPLITUDE=g{0}
upper{0}, 2, 2, 1."""

_COLLECTOR = '''\
"""abaqus python abaqus_to_csv.py paths.odb: writes tractions.csv for debond law --with."""
import csv
import sys

from odbAccess import openOdb

PATHS = {names!r}
with open('paths.csv') as stream:
    rows = list(csv.DictReader(stream))
frames = openOdb(sys.argv[1], readOnly=True).steps['paths'].frames
found = {{}}
for frame in frames:
    for value in frame.fieldOutputs['S'].values:
        key = PATHS[value.elementLabel - 1], int(round(frame.frameValue))
        found.setdefault(key, []).append((value.data[1], value.data[3]))
with open('tractions.csv', 'w') as stream:
    stream.write('path,step,g,s,p,t\\n')
    for row in rows:
        points = found[row['path'], int(row['step'])]
        p, t = (sum(point[i] for point in points) / len(points) for i in (0, 1))
        line = row['path'], row['step'], row['g'], row['s'], repr(float(p)), repr(float(t))
        stream.write(','.join(line) + '\\n')
'''


def abaqus_deck(bond: MixedBond, ways: Sequence[JumpPath], scene: str) -> str:
    """One COH2D4 of unit length for each path, its lower nodes held, its upper ones moved."""
    numbered = list(enumerate(ways, 1))
    elements = (
        _ELEMENT.format(name=way.name, i=i, n=range(4 * i - 3, 4 * i + 1), x=(2.0 * i - 2.0, 2.0 * i - 1.0))
        for i, way in numbered
    )
    amplitudes = (line for i, way in numbered for key in "gs" for line in _amplitude(f"{key}{i}", getattr(way, key)))
    return _DECK.format(
        scene=scene,
        notes="\n".join(f"** {text}" for text in _notes(bond)),
        elements="\n".join(elements),
        K=bond.slopes,
        p=bond.strength,
        G=bond.toughness,
        mixed="BK" if bond.criterion == "bk" else "POWER LAW",
        exponent=bond.exponent,
        amplitudes="\n".join(amplitudes),
        last=max(way.g.size for way in ways) - 1,
        boundaries="\n".join(_BOUNDARY.format(i) for i, _ in numbered),
    )


def _notes(bond: MixedBond) -> Iterator[str]:
    yield "S22 is the normal traction p, S12 the shear traction t; of thickness 1 the strain is the jump"
    yield "a user element takes the place of COH2D4 with *USER ELEMENT and the same nodes and amplitudes"
    if bond.onset_rule != "quadratic":
        yield "Abaqus has the quadratic onset alone: judge with --set interface.onset=quadratic"
    if bond.penalty != bond.slopes[0]:
        yield f"COH2D4 closes with the stiffness of opening: judge with --set interface.penalty={bond.slopes[0]:.12g}"
    if bond.friction or bond.pressure_strength:
        yield "friction and strength under pressure are not in this deck: judge without these keys of the interface"
    if bond.viscosity:
        yield "viscosity is not in this deck: judge with --set interface.viscosity=0"
    if bond.law != "bilinear":
        yield f"the {bond.law} law is not in this deck, which softens along a line: judge a scene with the bilinear one"


def _amplitude(name: str, value: np.ndarray) -> Iterator[str]:
    least = SMALLEST * float(np.abs(value).max())
    pairs = [f"{i}., {v:.15g}" for i, v in enumerate(np.where(np.abs(value) > least, value, 0.0).tolist())]
    yield f"*AMPLITUDE, NAME={name}, TIME=TOTAL TIME"
    yield from (", ".join(pairs[i : i + PAIRS_A_LINE]) for i in range(0, len(pairs), PAIRS_A_LINE))


def collector(ways: Sequence[JumpPath]) -> str:
    """A script for ``abaqus python`` that writes the tractions of the elements with the jumps that were written."""
    return _COLLECTOR.format(names=[way.name for way in ways])


#: Files of a deck for Abaqus, of the script that reads its results, of an input for MOOSE, of the notes.
DECK, COLLECTOR, MOOSE_BLOCK, GUIDE = "paths.inp", "abaqus_to_csv.py", "moose.i", "README.txt"

#: A complete input of MOOSE for one path: two elements of height one, 1e6 times as stiff as the bond, so that the jump
#: is the motion of the outer face of the upper one.
_MOOSE = """\
# Path {name}: of another one, change the file names and end_time, its number of steps less one.
# moose-opt -i moose.i -pc_type lu   writes {name}-moose.csv: time, g, s, p, t the stresses of the upper element
[Mesh]
  [two]
    type = GeneratedMeshGenerator
    dim = 2
    ny = 2
    ymin = -1
  []
  [upper]
    type = SubdomainBoundingBoxGenerator
    input = two
    block_id = 1
    block_name = upper
    bottom_left = '0 0 0'
    top_right = '1 1 0'
  []
  [split]
    type = BreakMeshByBlockGenerator
    input = upper
  []
[]
[GlobalParams]
  displacements = 'disp_x disp_y'
[]
[Physics/SolidMechanics/QuasiStatic/blocks]
  strain = SMALL
  add_variables = true
  generate_output = 'stress_xy stress_yy'
[]
[Physics/SolidMechanics/CohesiveZone/bond]
  boundary = Block0_upper
  strain = SMALL
[]
[Materials]
  [stiffness]
    type = ComputeIsotropicElasticityTensor
    youngs_modulus = {stiff:.12g}
    poissons_ratio = 0
  []
  [stress]
    type = ComputeLinearElasticStress
  []
  [law]
    type = BiLinearMixedModeTraction
    boundary = Block0_upper
    penalty_stiffness = {bond.slopes[0]:.12g}
    normal_strength = {bond.strength[0]:.12g}
    shear_strength = {bond.strength[1]:.12g}
    GI_c = {bond.toughness[0]:.12g}
    GII_c = {bond.toughness[1]:.12g}
    mixed_mode_criterion = {criterion}
    eta = {bond.exponent:.12g}
  []
[]
[Functions]
{functions}[]
[BCs]
{conditions}[]
[Postprocessors]
{columns}[]
{newton}  nl_rel_tol = 1e-10
  nl_abs_tol = {residual:.12g}
  dt = 1
  end_time = {last}
[]
[Outputs]
  [csv]
    type = CSV
    file_base = {name}-moose
  []
[]
"""

_PATH_NOTES = """\
Displacement paths for one point of the bond of {scene}: {count} paths, {steps} steps.

paths.csv   path,step,g,s: opening g and slip s of every step; each path begins undamaged at step 0
columns/    the same, a file a path: time,g,s
paths.inp   one COH2D4 a path for Abaqus/Standard, moved by amplitudes
abaqus_to_csv.py   abaqus python abaqus_to_csv.py paths.odb: writes tractions.csv
moose.i     a complete input for MOOSE, for one path

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
        MOOSE_BLOCK: _moose(bond, ways[0]),
        GUIDE: _PATH_NOTES.format(scene=scene, count=len(ways), steps=sum(steps), bond=bond, penalty=penalty),
    }
    for name, content in made.items():
        (folder / name).write_text(content, encoding="utf-8")
    for way in ways:  # over a time of one unit a step, as MOOSE and others read it
        rows = enumerate(zip(way.g.tolist(), way.s.tolist(), strict=True))
        content = "time,g,s\n" + "".join(f"{i},{g!r},{s!r}\n" for i, (g, s) in rows)
        (columns / f"{way.name}.csv").write_text(content, encoding="utf-8")
    return [folder / name for name in made]


def _moose(bond: MixedBond, way: JumpPath) -> str:
    """The input of MOOSE for one path."""
    read = {"type": "PiecewiseLinear", "data_file": f"columns/{way.name}.csv", "format": "columns"}
    read |= {"x_index_in_file": "0", "xy_in_file_only": "false"}
    outer = [("x", "s"), ("y", "g")]
    moved = {"type": "FunctionDirichletBC", "boundary": "top"}
    held = {"type": "DirichletBC", "boundary": "bottom", "value": "0"}
    jumps = {name: {"type": "FunctionValuePostprocessor", "function": name} for name in "gs"}
    mean = {"type": "ElementAverageValue", "block": "upper"}
    stresses = {name: {**mean, "variable": f"stress_{axis}y"} for name, axis in ("py", "tx")}
    return _MOOSE.format(
        name=way.name,
        bond=bond,
        stiff=1e6 * max(bond.slopes),
        criterion="POWER_LAW" if bond.criterion == "power" else "BK",
        functions="".join(block(one, **read, y_index_in_file=str(i)) for i, one in enumerate("gs", 1)),
        conditions="".join(
            block(f"top_{axis}", **moved, variable=f"disp_{axis}", function=one)
            + block(f"bottom_{axis}", **held, variable=f"disp_{axis}")
            for axis, one in outer
        ),
        columns="".join(block(name, **of) for name, of in (jumps | stresses).items()),
        residual=1e-9 * min(bond.strength),
        newton=NEWTON,
        last=way.g.size - 1,
    )
