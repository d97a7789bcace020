"""Specimens of AS4/PEEK arms in plain numbers."""

from __future__ import annotations

from dataclasses import replace

from verify.theory.arms.problem import Arm, ArmsProblem, Load, Support
from verify.theory.mixed_law import MixedBond

LAW = MixedBond("bilinear", (80.0, 100.0), (0.969, 1.719), (1e5, 1e5), 1e5, "bk", 2.284)
ARM = Arm(1.56, 122.7e3 / (1 - 0.25**2 * 10.1 / 122.7), 10.1e3 / (1 - 0.45**2), 5.5e3)
#: Half span, width.
L, WIDTH = 51.0, 25.4


def roller(x: float, half: float = 0.0) -> tuple[float, float]:
    return max(x - half, 0.0), min(x + half, 2 * L)


def push(x: float, share: float, half: float = 0.0) -> Load:
    return Load(0, "top", share, roller(x, half))


def hold(body: int, x: float, half: float = 0.0) -> Support:
    return Support(body, "bottom", roller(x, half))


BELOW = hold(1, 0.0), hold(1, 2 * L)
GUIDED = Support(None, "right"), Support(None, "right", couple=True)
APART = Load(0, "left", 1.0), Load(1, "left", -1.0)

#: Of the rollers, points, so that closed forms hold.
ENF = ArmsProblem((ARM, ARM), 2 * L, (39.3, 2 * L), WIDTH, (push(L, -1.0),), BELOW, LAW, 6.0)
SLB = replace(ENF, supports=(hold(0, 0.0), hold(1, 2 * L)), bonded=(30.0, 2 * L), opening=5.0)
FOUR_POINT = replace(ENF, loads=(push(30.0, -0.5), push(72.0, -0.5)), bonded=(40.0, 2 * L))
ELS = replace(ENF, loads=(push(0.0, -1.0),), supports=GUIDED, bonded=(60.0, 2 * L), opening=20.0)
DCB = replace(ENF, loads=APART, supports=(), bonded=(30.0, 2 * L))


def mmb(lever: float, half: float = 0.0) -> ArmsProblem:
    """A mixed-mode bending test on rollers of the length 2 ``half``."""
    loads = push(0.0, lever / L, half), push(L, -(lever + L) / L, half)
    return replace(on_rollers(ENF, half), loads=loads, bonded=(34.1, 2 * L), opening=11.0)


def on_rollers(problem: ArmsProblem, half: float) -> ArmsProblem:
    """With supports below the lower arm, and a load at mid-span, on patches of the length 2 ``half``."""
    return replace(problem, loads=(push(L, -1.0, half),), supports=(hold(1, 0.0, half), hold(1, 2 * L, half)))


def moments(upper: float, lower: float) -> ArmsProblem:
    """Moments on the arms, above 0 where they bend them upwards."""
    loads = Load(0, "left", -upper, couple=True), Load(1, "left", -lower, couple=True)
    return replace(ENF, loads=loads, supports=GUIDED, bonded=(40.0, 2 * L), opening=0.2)
