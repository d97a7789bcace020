"""`debond law`: the paths of a scene, and the verdict on the law of the solvers or of a user."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from verify.scene.bond.bond import bond_of
from verify.scene.bond.mixed import mixed_bond
from verify.scene.effects import simulated
from verify.scene.laws import TABULAR
from verify.scene.schema import Scene
from verify.studies.law.definitions import DEFINITIONS, defined
from verify.studies.law.judge import EXACT, Judgement, Tolerances, judge
from verify.studies.law.laws import built_in, followed, function, modelled, of_function
from verify.studies.law.paths import JumpPath, paths
from verify.studies.law.read import read_paths
from verify.support.refusal import Refusal, one_of
from verify.theory.mixed_law import KNOWN_MIXED_LAWS, MixedBond
from verify.verdict import Check

#: No definition.
NONE = "none"
#: Name of the law of the solvers.
BUILT_IN = "the law of the solvers"


@dataclass(frozen=True)
class Subject:
    """A scene, its bond and its paths; without shear both modes of the bond have the numbers of opening."""

    scene: Scene
    bond: MixedBond
    ways: tuple[JumpPath, ...]
    compared: bool = True


def subject(scene: Scene, definition: str | None = None) -> Subject:
    """The bond of a scene that is judged, and its paths; with another ``definition`` than the law of the scene, or
    with `NONE`.

    Raises
    ------
    Refusal : a law without a definition here, or without history.
    """
    effects, i = simulated(scene), scene.interface
    if not effects["irreversible"]:
        raise Refusal("effects.irreversible: must be true for debond law, which judges damage, got false")
    bond = mixed_bond(scene)
    if bond is None:
        if i.law not in KNOWN_MIXED_LAWS:
            raise Refusal(f"interface.law: must be {one_of(KNOWN_MIXED_LAWS)} for debond law, got {i.law!r}")
        onset = i.table[0][1] if i.law == TABULAR else i.strength
        pairs = {"strength": onset, "toughness": i.toughness, "stiffness": i.bond_stiffness}
        numbers = vars(bond_of(scene, {**effects, "shear": False}))
        bond = MixedBond(**{**numbers, **{key: (one, one) for key, one in pairs.items()}})
    if definition not in (None, NONE):
        if definition not in DEFINITIONS:
            raise Refusal(f"--definition: must be {one_of((*DEFINITIONS, NONE))}, got {definition!r}")
        bond = defined(bond, definition)
    return Subject(scene, bond, paths(bond, i.slides), definition != NONE)


def judge_built_in(of: Subject) -> Judgement:
    """The law of ``iga``, step by step, against the definition and, where it slides, that of ``fem_reference``."""
    slides = of.scene.interface.slides
    law = built_in(of.bond if slides else bond_of(of.scene, {**simulated(of.scene), "shear": False}))
    found = judge(of.bond, of.ways, {way.name: of_function(law, way, BUILT_IN) for way in of.ways}, EXACT)
    if not slides:
        return found
    other, checks = modelled(of.bond), [*found.checks]
    for case in found.cases:
        off = case.apart(case.given, of_function(other, case.way, "fem_reference"))[1]
        text = "Largest distance of the tractions from those of the law of fem_reference, in parts of the strengths."
        checks.append(Check("other-code", case.way.name, off, EXACT.tractions, "cross-code", text))
    return replace(found, checks=tuple(checks))


def judge_given(
    of: Subject, text: str, names: Mapping[str, str], scales: Mapping[str, float], tolerance: float | None
) -> Judgement:
    """A law that is named on the command line, ``module:function``, ``file.py:function`` or a file of tractions.

    Raises
    ------
    Refusal : no such module, function or file, or one that gives no tractions.
    """
    tolerances = Tolerances() if tolerance is None else Tolerances(tolerance)
    law = function(text)
    if law is None:
        return judge(of.bond, *read_paths(Path(text), of.ways, names, scales), tolerances, compared=of.compared)
    if names or scales:
        raise Refusal(f"--columns, --scales: must be left out with a function, got them with {text}")
    given, far = followed(law, of.ways, text)
    return judge(of.bond, of.ways, given, tolerances, far, of.compared)
