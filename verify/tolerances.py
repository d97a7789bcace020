"""What every tolerance of the checks follows from, and every constant that decides whether a check judges.

A tolerance that follows from measurements alone (`MEASURED`) ends where these end; a test holds their list, so that no
further one is added unseen. The page ``docs/pages/theory/tolerances.md`` is this list.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

Source = Literal[
    "rounding", "iteration", "steps", "second mesh", "next order", "stated", "requirement", "convention", "measured"
]


@dataclass(frozen=True)
class Follows:
    """Where a number comes from: its kind of source, and how."""

    source: Source
    how: str


_CURVES = Follows("requirement", "0.5 % of the curve, with the error of either mesh from its second one beside it")
_LEGS = Follows("requirement", "that of the curve, with the error of either mesh on the same leg beside it")
_RESIDUAL = Follows("iteration", "the norm of forces at which the solver stops, and rounding of its stiffness")

#: By the name of the check.
TOLERANCES: Mapping[str, Follows] = {
    "completed": Follows("rounding", "the control of the opening ends on the number of the programme"),
    "penetration": Follows(
        "next order",
        "the pressure is known at the points of integration; linear between two Gauss points it is 1.37 times as large "
        "at the end of the element. Beyond that the error of interpolation of an arm that bends and shears",
    ),
    "j-integral": Follows("requirement", "0.5 % of J is 0.25 % of a load that grows a crack; error of the method"),
    "j-pressed": Follows("measured", "up to 0.05 at the edge of a body, where the stress varies within an element"),
    "growth-load": Follows("requirement", "that of J"),
    "growth-angle": Follows(
        "measured", "up to 0.1 % on the packaged scenes: energy in unloaded ends of strip and substrate"
    ),
    "energy-ledger": Follows(
        "steps",
        "a step is off its tangent by discretization.bend of the peak, 0.5 %: the trapezoid of its work misses a sixth "
        "of that times the step",
    ),
    "secant": Follows(
        "next order",
        "a fiftieth of the tolerance of the curve; with finite kinematics half the term of second order in the "
        "rotations (elastica), as the first is taken from the stored energy",
    ),
    "interface-force": _RESIDUAL,
    "moment-balance": _RESIDUAL,
    "clamp-moment": _RESIDUAL,
    "lengthwise": _RESIDUAL,
    "reactions": _RESIDUAL,
    "supports": _RESIDUAL,
    "arm-balance": _RESIDUAL,
    "dissipation": Follows(
        "measured",
        "up to 0.11 % on the packaged scenes; the crack is known to a point of the bond, and a zone that changes its "
        "length holds up to half of that",
    ),
    "j-loads": Follows("requirement", "that of J; 0.2 % for an end-notched flexure"),
    "mode-ratio": Follows(
        "requirement",
        "twice that of J, a quotient of two; of a slb what stocky arms and a long zone take from 3/7",
    ),
    "moments": Follows("requirement", "0.6 of that of J, which these moments give exactly"),
    "moments-elastic": Follows("iteration", "a linear problem, solved to a residual of its own"),
    "growth-toughness": Follows("requirement", "0.6 of that of J, which a steady zone gives exactly"),
    "plateau": Follows("requirement", "that of the curve: the load of the plateau is one of it"),
    "curve": _CURVES,
    "peak": _CURVES,
    "stiffness": _CURVES,
    "farthest-point": Follows("convention", "a point may be four times as far off as a curve"),
    "curve-leg": _LEGS,
    "slope-leg": _LEGS,
    "residual-leg": _LEGS,
    "loop-leg": _LEGS,
    "plane-curve": Follows("next order", "distance of order 3 from order 5, with what the mesh of the code leaves"),
    "beam-curve": Follows("next order", "distance of order 1 from order 3, and that of `plane-curve`"),
    "end": Follows("requirement", "a fifth of the tolerance of the curve"),
    "legs": Follows("requirement", "a fifth of the tolerance of the curve"),
}

#: By the name of the constant below ``verify``.
CONSTANTS: Mapping[str, Follows] = {
    "checks.between_codes.CODE_TOLERANCE": Follows("requirement", "what two codes are asked for, 0.5 %"),
    "checks.between_codes.A_THOUSANDTH": Follows("requirement", "a fifth of the tolerance of the curve"),
    "checks.orders.NO_JUDGE": Follows("convention", "a judge that is 3 % off tells no two codes apart"),
    "checks.orders.SAID": Follows("requirement", "that of the curve"),
    "checks.between_codes.COARSE": Follows("measured", "17 % with elements longer than a third of the zone"),
    "checks.proof.TRUST": Follows(
        "measured", "models differ by 0 to 2 % on 60 random scenes; half a tolerance of uncertainty changes no verdict"
    ),
    "checks.matched.LEAST_TRACTION": Follows("convention", "a hundredth of the strength bears nothing"),
    "checks.neglected.OVERLAP": Follows("measured", "0.6 g_max at most ahead of a growing crack"),
    "checks.neglected.LARGEST_RATIO": Follows("rounding", "of tractions"),
    "checks.neglected.SAME_CONTROL_POINT": Follows("rounding", "of control points in files"),
    "checks.mechanics.balance.RESIDUAL": Follows(
        "iteration", "Newton's tolerance and machine epsilons; numbers of epsilons were counted in runs"
    ),
    "checks.mechanics.j_integral.J_TOLERANCE": Follows("requirement", "see `j-integral`"),
    "checks.mechanics.unresolved.LEFT_BY_IGA": Follows("measured", "0.12 to 0.70 over n^2, n of 0.5 to 8 elements"),
    "checks.mechanics.unresolved.LEFT_BY_DOLFINX": Follows("measured", "0.01 to 0.71 over n^2, n of 0.2 to 14"),
    "checks.mechanics.j_integral.FAR_END_SHARE": Follows("requirement", "half of the tolerance of J"),
    "checks.mechanics.mixed.BALANCE_OF_J": Follows("requirement", "that of J"),
    "checks.mechanics.mixed.BALANCE_OF_J_ENF": Follows("requirement", "0.4 of that of J"),
    "checks.mechanics.mixed.OF_THE_MODE": Follows("requirement", "see `mode-ratio`"),
    "checks.mechanics.mixed.PURE": Follows("convention", "a mode is pure to a thousandth"),
    "checks.mechanics.mixed.ZONES_GROWN": Follows("convention", "a cost per length takes several lengths of the zone"),
    "checks.mechanics.mixed.ROUNDED_J": Follows("rounding", "of J where the loads pass through zero"),
    "checks.mechanics.columns.AWAY": Follows("next order", "end stresses decay as exp(-pi x / 2 t), 0.9 % at three t"),
    "checks.mechanics.peel_growth.AT_THE_END": Follows("rounding", "of the damage front"),
    "checks.mechanics.penetration.NO_DEPTH": Follows("convention", "a millionth of an arm is no depth"),
    "checks.mechanics.penetration.INTERPOLATED": Follows("next order", "Peano's constants of interpolation"),
    "checks.mechanics.penetration.SHEAR_OF_ARM": Follows("stated", "shear factor of a rectangle, 5/6"),
    "checks.mechanics.secant.SECANT_TOLERANCE": Follows("requirement", "a fiftieth of the tolerance of the curve"),
    "checks.mechanics.secant.MOST": Follows("convention", "a law that unloads 3 % off is to be found"),
    "checks.mechanics.secant.SOFTER": Follows(
        "measured", "bonds from soft to rigid, both limits; bounds what stored energy may pass for geometry"
    ),
    "checks.mechanics.secant.ON_A_LINE": Follows("next order", "largest value of x - x^3"),
    "checks.mechanics.secant.LEAST_LINE": Follows("rounding", "a separated specimen bears rounding"),
    "checks.mechanics.secant.NO_GROWTH": Follows("rounding", "of the dissipated energy"),
    "methods.second_meshes.FIRST_ORDER": Follows("next order", "an error that falls with the layers, or faster"),
    "scene.schema.MOST_THROUGH": Follows("stated", "what a scene takes"),
    "curves.legs.SAME_TURN": Follows("rounding", "of turns in files"),
    "curves.legs.TURN_TOLERANCE": Follows("requirement", "a fifth of the tolerance of the curve"),
    "curves.legs.DEEP": Follows("convention", "a fall of 5 % of the largest opening is an unloading"),
    "curves.legs.LOST": Follows("convention", "a crack that grows loses more than 2 % of the work of a loop"),
    "curves.legs.LOADED": Follows("convention", "a fifth of the load tells a compliance"),
    "curves.legs.SNAPS": Follows("measured", "0.6 to 1 of snap-backs, 0.13 of an unloading that keeps 5 %"),
    "curves.leg_checks.LOADS_ALONE": Follows("requirement", "a fifth of the tolerance of the curve"),
    "curves.leg_checks.GOES_BACK": Follows("convention", "a fall of 1 % is no noise"),
    "curves.leg_checks.TELLS_SLOPE": Follows("convention", "a leg that unloads a quarter has a slope"),
    "curves.leg_checks.TELLS_RESIDUAL": Follows("convention", "one that unloads a half tells where it would end"),
    "curves.leg_checks.TELLS_STIFFNESS": Follows("convention", "a fifth of half the load tells a stiffness"),
    "curves.leg_checks.CLEAR": Follows("convention", "faces begin to touch below a fifth of the opening"),
    "curves.leg_checks.NO_MATTER": Follows("requirement", "a quarter of a tolerance changes no verdict"),
    "curves.leg_checks.OF_A_POINT": Follows("convention", "a point may be four times as far off as a curve"),
    "curves.scatter.FULL_PRECISION": Follows("rounding", "more digits than a curve is judged to"),
    "curves.scatter.SHARED_BY": Follows("convention", "by chance so many share twice their quantum once in 256"),
    "curves.scatter.QUANTUM_GROUPS": Follows("convention", "of rows of one size, which share their digits"),
    "curves.scatter.AT_ONE_OPENING": Follows("rounding", "differences of rows nearer have few digits"),
    "curves.scatter.RESIDUALS": Follows("convention", "fewer residuals show no noise"),
    "curves.scatter.ROUGH": Follows("rounding", "of most rows, over half a quantum"),
    "curves.scatter.ALIKE": Follows("convention", "noise is alike before and behind the peak, a ripple is not"),
    "curves.scatter.SIGMAS": Follows("convention", "noise reaches it in one of a million rows"),
    "curves.scatter.CHANGING_STEPS": Follows("convention", "steps that change by a fifth are chosen"),
    "checks.foreign.given.BEARS_NO_LOAD": Follows("convention", "a hundredth of the load is none"),
    "checks.foreign.given.LATE": Follows("convention", "a hundredth of the programme is its beginning"),
    "curves.scatter.LEFT_BY_A_MEAN": Follows("requirement", "a quarter of a tolerance changes no verdict"),
    "curves.scatter.MOST_OF_A_MEAN": Follows("convention", "a mean of a tenth of the rows is a local one"),
    "curves.convergence.GCI_SAFETY": Follows("stated", "Roache (1994), for three or more meshes"),
    "curves.convergence.STEADY": Follows("convention", "orders of successive triples within a tenth"),
    "curves.convergence.MESH_ESTIMATE": Follows("next order", "orders 1 and 2 over the range of three meshes (Eca)"),
}

#: What follows from measurements alone.
MEASURED = frozenset(name for name, one in {**TOLERANCES, **CONSTANTS}.items() if one.source == "measured")


def tables() -> tuple[str, str]:
    """Both lists as tables of Markdown."""
    found = []
    for head, rows in (("check", TOLERANCES), ("constant", CONSTANTS)):
        lines = [f"| {head} | source | how |", "|---|---|---|"]
        lines += [f"| `{name}` | {one.source} | {one.how} |" for name, one in rows.items()]
        found.append("\n".join(lines))
    return found[0], found[1]
