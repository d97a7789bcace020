"""Bias of a reduction: the toughness that it finds in a run against the toughness of the scene."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan

from verify.reduction.coupon import REDUCED, coupon
from verify.reduction.data import of_steps
from verify.reduction.initiation import FIVE, NL
from verify.reduction.reduce import Reduced, Reduction, reduce
from verify.reduction.scheme import Settings
from verify.reduction.schemes import ALL_SLIDES
from verify.result import Result
from verify.scene.bond.mixed import mixed_bond
from verify.scene.schema import Scene
from verify.studies.reduce.source import Given
from verify.support.refusal import Refusal


@dataclass(frozen=True)
class Bias:
    """Toughness ``known`` of the scene at the mode ratio of a scheme, and the scheme's G over it, minus 1, for
    propagation and for initiation by non-linearity and by 5 % or maximum load."""

    scheme: Reduced
    known: float
    propagation: float
    nonlinear: float
    five: float


def biases(found: Reduction, scene: Scene) -> tuple[Bias, ...]:
    """The bias of each scheme with a result; none for an adcb, whose mode ratio beam theory does not give, and for a
    peel test whose bond slides."""
    bond, by_compliance = mixed_bond(scene), found.by_name.get("CBBM")
    opens = {"dcb": 0.0, "peel": 0.0 if bond is None else nan, **dict.fromkeys(ALL_SLIDES, 1.0)}
    ratio = opens.get(found.coupon.kind, by_compliance.mixture if by_compliance else nan)
    if ratio != ratio:
        return ()
    known = scene.interface.toughness if bond is None else float(bond.critical(ratio))
    points = ("propagation", NL, FIVE)
    return tuple(
        Bias(one, known, *(one.at(point).value / known - 1.0 for point in points))
        for one in found.schemes
        if not one.missing
    )


def of_run(scene: Scene, result: Result, source: str = "run") -> Reduction | None:
    """The reduction of a run, treated as a test without toe and noise; None where the specimen cannot be reduced, the
    run is not complete, or its programme has reversals."""
    whole = len({column.size for column in result.steps.values()}) == 1
    if scene.specimen.kind not in REDUCED or len(scene.load.opening) > 1 or not (result.complete and whole):
        return None
    try:
        specimen = coupon(scene)
        given = Given(of_steps(source, result.steps, specimen), scene, specimen, True)
        return reduce(given.measured, specimen, given.settings(Settings(), None))
    except Refusal:
        return None
