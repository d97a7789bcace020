"""`debond law`: the paths of a scene, and the verdict on the law of the solvers or of a user."""

from __future__ import annotations

from dataclasses import dataclass, replace

from verify.scene.bond.mixed import mixed_bond
from verify.scene.effects import simulated
from verify.scene.laws import TABULAR
from verify.scene.schema import Scene
from verify.studies.law.distance import apart
from verify.studies.law.given.answer import Answer, of_function
from verify.studies.law.given.built_in import built_in, modelled, opening_law
from verify.studies.law.given.read import PathColumns
from verify.studies.law.given.source import answered
from verify.studies.law.judge import Judgement, Tolerances, judge
from verify.studies.law.opening_bond import opening_bond
from verify.studies.law.ways.legs import JumpPath
from verify.studies.law.ways.paths import paths
from verify.support.refusal import Refusal, one_of
from verify.theory.law import Tabular
from verify.theory.mixed_law import KNOWN_MIXED_LAWS, MixedBond
from verify.verdict import Check

#: Name of the law of the solvers.
BUILT_IN = "the law of the solvers"


@dataclass(frozen=True)
class Subject:
    """The bond of a scene and its paths; without ``shear`` it only opens, and both modes have the same numbers."""

    bond: MixedBond
    shear: bool
    ways: tuple[JumpPath, ...]


def subject(scene: Scene) -> Subject:
    """The bond of a scene that is judged, and its paths.

    Raises
    ------
    Refusal : a law without a definition here, or without history.
    """
    effects = simulated(scene)
    if not effects["irreversible"]:
        raise Refusal("effects.irreversible: must be true for debond law, which judges damage, got false")
    found = mixed_bond(scene)
    if found is not None:
        return Subject(found, True, paths(found))
    bond = _opening(scene, effects["contact"])
    return Subject(bond, False, paths(bond, shear=False))


def _opening(scene: Scene, contact: bool) -> MixedBond:
    """The bond of a scene that only opens, with the numbers of opening for both modes."""
    i = scene.interface
    if i.law == TABULAR:
        return opening_bond(Tabular(i.strength, i.toughness, i.ductility, i.penalty, contact, table=i.table))
    if i.law not in KNOWN_MIXED_LAWS:
        raise Refusal(f"interface.law: must be {one_of((*KNOWN_MIXED_LAWS, TABULAR))} for debond law, got {i.law!r}")
    strength, toughness, slope = ((one, one) for one in (i.strength, i.toughness, i.bond_stiffness))
    return MixedBond(i.law, strength, toughness, slope, i.penalty, contact=contact, plateau=i.plateau)


def judge_built_in(of: Subject) -> Judgement:
    """The law of ``iga``, step by step, against the definition and against the law of ``fem_reference``."""
    law = built_in(of.bond) if of.shear else opening_law(of.bond)
    given = {way.name: of_function(law, way, BUILT_IN) for way in of.ways}
    found = judge(of.bond, of.ways, given, Tolerances.exact())
    if not of.shear:
        return found
    other = modelled(of.bond)
    across = [_across(of.bond, way, given[way.name], of_function(other, way, "fem_reference")) for way in of.ways]
    return replace(found, checks=(*found.checks, *across))


def _across(bond: MixedBond, way: JumpPath, given: Answer, other: Answer) -> Check:
    meaning = "Largest distance of the tractions from those of the law of fem_reference, in parts of the strengths."
    value = float(apart(bond, given, other).max())
    return Check("other-code", way.name, value, Tolerances.exact().tractions, "cross-code", meaning)


def judge_given(of: Subject, text: str, columns: PathColumns, tolerance: float | None) -> Judgement:
    """A law that is named on the command line, a file or a function (`verify.studies.law.given.source`)."""
    ways, given = answered(text, of.ways, columns)
    tolerances = Tolerances() if tolerance is None else replace(Tolerances(), tractions=tolerance)
    return judge(of.bond, ways, given, tolerances)
