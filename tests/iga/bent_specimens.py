"""Bonds that open and slide, and specimens that are bent between rollers, for tests."""

from typing import Any

from iga.delamination.problem import Problem
from iga.laws.laws import ShapedLaw
from iga.laws.mode_ratio import ModeRatio
from iga.specimen.layout import Load, Moduli, Rectangle, Support

#: A carbon fibre composite (AS4/PEEK), N and mm: two arms, and a bond of equal stiffness in opening and sliding.
ARM = Rectangle(102.0, 1.56, Moduli(E1=122.7e3, E2=10.1e3, G12=5.5e3, nu12=0.25))
MODES = ModeRatio((0.969, 1.719), (80.0, 100.0), (1e5, 1e5), "bk", 2.284, "turon")
ROLLERS = Support(1, "bottom", (0.0, 0.5)), Support(1, "bottom", (101.5, 102.0))
#: Half the distance of the rollers, and what is pressed down in the middle.
HALF = 51.0
PRESSED = (HALF - 0.5, HALF + 0.5)


def bond(penalty: float = 1e5, modes: ModeRatio = MODES, **keys: Any) -> ShapedLaw:
    return ShapedLaw(modes, penalty, **keys)


def flexure(**keys: Any) -> Problem:
    """An end-notched flexure: three rollers, the bond slides alone."""
    base: dict[str, Any] = {
        "bodies": (ARM, ARM),
        "bonded": (39.3, 102.0),
        "supports": ROLLERS,
        "loads": (Load(0, "top", -1.0, PRESSED),),
        "loaded_at": 0.0,
        "bond": bond(),
        "width": 25.4,
        "plane": "strain",
        "kinematics": "linear",
        "opening": (6.0,),
        "dofs": 1000,
        "steps": None,
    }
    return Problem(**{**base, **keys})


def mixed_bending(lever: float = 44.4, **keys: Any) -> Problem:
    """The same with a lever, which pulls the upper arm's left end up: the bond opens and slides."""
    down, up = -(lever + HALF) / HALF, lever / HALF
    loads = Load(0, "top", down, PRESSED), Load(0, "top", up, (0.0, 0.5))
    return flexure(**{"loads": loads, "bonded": (34.1, 102.0), "opening": (11.0,), **keys})
