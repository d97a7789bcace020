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


def abaqus_lines(bond: MixedBond, ways: Sequence[JumpPath], scene: str) -> Iterator[str]:
    """One COH2D4 of unit length for each path, its lower nodes held, its upper ones moved; step i is at time i."""
    last = max(way.g.size for way in ways) - 1
    yield "*HEADING"
    yield f"debond law {scene}: a cohesive element for each path"
    yield from (f"** {text}" for text in _notes(bond))
    for i, way in enumerate(ways):
        yield from _element(i, way)
    yield "*COHESIVE SECTION, ELSET=bond, MATERIAL=bond, RESPONSE=TRACTION SEPARATION, THICKNESS=SPECIFIED"
    yield "1., 1."
    yield from _material(bond)
    for i, way in enumerate(ways):
        yield from _amplitude(f"g{i + 1}", way.g)
        yield from _amplitude(f"s{i + 1}", way.s)
    yield "*STEP, NAME=paths, NLGEOM=NO, INC=100000"
    yield "*STATIC, DIRECT"
    yield f"1., {last}."
    for i, _ in enumerate(ways):
        yield "*BOUNDARY"
        yield f"lower{i + 1}, 1, 2"
        for key, component in (("s", 1), ("g", 2)):
            yield f"*BOUNDARY, AMPLITUDE={key}{i + 1}"
            yield f"upper{i + 1}, {component}, {component}, 1."
    yield "*OUTPUT, FIELD, FREQUENCY=1"
    yield "*ELEMENT OUTPUT, ELSET=bond"
    yield "S, SDEG"
    yield "*END STEP"


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


def _element(i: int, way: JumpPath) -> Iterator[str]:
    first = 4 * i + 1
    yield f"** path {way.name}"
    yield f"*NODE, NSET=nodes{i + 1}"
    for n, x in enumerate((0.0, 1.0, 1.0, 0.0)):
        yield f"{first + n}, {2.0 * i + x:g}, 0."
    yield "*ELEMENT, TYPE=COH2D4, ELSET=bond"
    yield f"{i + 1}, {first}, {first + 1}, {first + 2}, {first + 3}"
    yield f"*NSET, NSET=lower{i + 1}"
    yield f"{first}, {first + 1}"
    yield f"*NSET, NSET=upper{i + 1}"
    yield f"{first + 2}, {first + 3}"


def _material(bond: MixedBond) -> Iterator[str]:
    (K, Ks), (p, t), (first, second) = bond.slopes, bond.strength, bond.toughness
    mixed = "BK" if bond.criterion == "bk" else "POWER LAW"
    yield "*MATERIAL, NAME=bond"
    yield "*ELASTIC, TYPE=TRACTION"
    yield f"{K:.12g}, {Ks:.12g}, {Ks:.12g}"
    yield "*DAMAGE INITIATION, CRITERION=QUADS"
    yield f"{p:.12g}, {t:.12g}, {t:.12g}"
    yield f"*DAMAGE EVOLUTION, TYPE=ENERGY, MIXED MODE BEHAVIOR={mixed}, POWER={bond.exponent:.12g}"
    yield f"{first:.12g}, {second:.12g}, {second:.12g}"


def _amplitude(name: str, value: np.ndarray) -> Iterator[str]:
    least = SMALLEST * float(np.abs(value).max())
    pairs = [f"{i}., {v:.15g}" for i, v in enumerate(np.where(np.abs(value) > least, value, 0.0).tolist())]
    yield f"*AMPLITUDE, NAME={name}, TIME=TOTAL TIME"
    yield from (", ".join(pairs[i : i + PAIRS_A_LINE]) for i in range(0, len(pairs), PAIRS_A_LINE))


def collector(ways: Sequence[JumpPath]) -> Iterator[str]:
    """A script for ``abaqus python`` that writes the tractions of the elements with the jumps that were written."""
    yield '"""abaqus python abaqus_to_csv.py paths.odb: writes tractions.csv for debond law --with."""'
    yield "import csv"
    yield "import sys"
    yield ""
    yield "from odbAccess import openOdb"
    yield ""
    yield f"PATHS = {[way.name for way in ways]!r}"
    yield "with open('paths.csv') as stream:"
    yield "    rows = list(csv.DictReader(stream))"
    yield "frames = openOdb(sys.argv[1], readOnly=True).steps['paths'].frames"
    yield "found = {}"
    yield "for frame in frames:"
    yield "    for value in frame.fieldOutputs['S'].values:"
    yield "        key = PATHS[value.elementLabel - 1], int(round(frame.frameValue))"
    yield "        found.setdefault(key, []).append((value.data[1], value.data[3]))"
    yield "with open('tractions.csv', 'w') as stream:"
    yield "    stream.write('path,step,g,s,p,t\\n')"
    yield "    for row in rows:"
    yield "        points = found[row['path'], int(row['step'])]"
    yield "        p, t = (sum(point[i] for point in points) / len(points) for i in (0, 1))"
    yield "        line = row['path'], row['step'], row['g'], row['s'], repr(float(p)), repr(float(t))"
    yield "        stream.write(','.join(line) + '\\n')"
