"""Specimens whose bond slides, for the tests: arms of carbon fibres in PEEK, 102 mm between the supports."""

from __future__ import annotations

from dataclasses import replace

from fem_reference.problem.delamination import Problem
from fem_reference.problem.loads import Load, Support
from fem_reference.problem.material import Moduli, Rectangle
from fem_reference.problem.mixed_laws import ByCriterion

HALF_SPAN, LEVER = 51.0, 44.4
LAW = ByCriterion(
    strength=80.0,
    shear_strength=100.0,
    toughness=0.969,
    shear_toughness=1.719,
    stiffness=1e5,
    shear_stiffness=1e5,
    penalty=1e5,
    criterion="bk",
    exponent=2.284,
    onset="turon",
)
ARM = Rectangle(102.0, 1.56, Moduli(122.7e3, 10.1e3, 5.5e3, 0.25, 0.45))
MIDDLE = (50.5, 51.5)
ON_ROLLERS = Support(1, "bottom", (0.0, 0.5)), Support(1, "bottom", (101.5, 102.0))
GUIDED = Support(None, "right"), Support(None, "right", couple=True)

#: End notched flexure.
ENF = Problem(
    bodies=(ARM, ARM),
    bonded=(39.3, 102.0),
    loads=(Load(0, "top", -1.0, MIDDLE),),
    supports=ON_ROLLERS,
    bond=LAW,
    width=25.4,
    plane="strain",
    opening=(6.0,),
    kinematics="linear",
    elements=204,
    layers=2,
    steps=60,
)
#: Mixed-mode bending, half of G_c in mode II.
MMB = replace(
    ENF,
    bonded=(34.1, 102.0),
    opening=(11.0,),
    loads=(
        Load(0, "top", LEVER / HALF_SPAN, (0.0, 0.5)),
        Load(0, "top", -(LEVER + HALF_SPAN) / HALF_SPAN, MIDDLE),
    ),
)
ALUMINIUM = Rectangle(102.0, 0.6, Moduli(70e3, 70e3, 27e3, 0.3, 0.3))
#: Single-leg bending: on the left the upper arm alone is carried.
SLB = replace(
    ENF, bodies=(ALUMINIUM, ALUMINIUM), supports=(Support(0, "bottom", (0.0, 0.5)), ON_ROLLERS[1]), elements=102
)


def under_moments(first: float, second: float, **changes: object) -> Problem:
    """Arms under moments at the left end, positive ones bend upwards; the far end is guided."""
    loads = Load(0, "left", -first, couple=True), Load(1, "left", -second, couple=True)
    return replace(ENF, **{"loads": loads, "supports": GUIDED} | changes)


def pulled_apart(**changes: object) -> Problem:
    """Arms pulled apart at the left end, without supports."""
    return replace(ENF, **{"loads": (Load(0, "left", 1.0), Load(1, "left", -1.0)), "supports": ()} | changes)
