"""Single cohesive elements for Abaqus/Standard, one for each displacement path, and a script that reads the results."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from verify.studies.law.paths import JumpPath
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
