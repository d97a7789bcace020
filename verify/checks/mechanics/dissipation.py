"""What a new length of crack costs: the slope of the dissipated energy over the length of the crack."""

from __future__ import annotations

from collections.abc import Callable
from math import nan

import numpy as np

from verify.checks.mechanics import mixed
from verify.checks.mechanics.columns import Steps, far_from_end, zone_is_free
from verify.checks.mechanics.identity import identity
from verify.methods.method import Prepared
from verify.result import Result
from verify.scene.effects import simulated
from verify.scene.process_zone import zone_length
from verify.scene.schema import Scene


def _meaning(scene: Scene) -> str:
    cost = "G_c or, between the modes, J" if simulated(scene)["shear"] else "G_Ic"
    return f"A new length of crack costs {cost} times the width."


def dissipation_tolerance(prepared: Prepared, result: Result) -> float:
    """2 %, and half of the change of the process zone with the crack, see `dissipation_gap`: as it is in the run, and
    up to that of a zone of twice the estimated length which forms or vanishes meanwhile."""
    scene, crack = prepared.scene, result.steps["crack_length"]
    if (slopes := _slopes(scene, result.steps)) is None:
        return 0.02
    most = 2.0 * zone_length(scene) / float(np.ptp(crack))
    return 0.02 + 0.5 * min(abs(slopes[1]), most)


@identity("dissipation", dissipation_tolerance, _meaning, "crack_length", "dissipated_energy", element=True)
def dissipation_gap(scene: Scene, steps: Steps, element: Callable[[], float] = lambda: nan) -> float | None:
    """|slope of the dissipated energy over the crack length / (G_Ic w) - 1|; None for less than five thicknesses or
    three elements of new crack.

    The crack ends in the middle of its process zone of length l. The zone holds the energy c G_Ic w l, with c between
    0 and 1: what its middle leaves of a change of l is ``(c - 1/2) dl/da``. Measured: c from 0.42 to 0.50 on
    bilinear laws with zones of 0.16 to 9 mm, 0.37 on a trapezoidal and 0.24 on an exponential one.

    The steps count from the first crack growth on, when the process zone is complete, until the zone reaches the far
    end. The slope is fitted by least squares: a difference of the first and the last step would contain the energy
    dissipated between integration points, a few percent on a coarse mesh.

    ``element`` returns the longest element of the bond; it builds a mesh and is called last. Where the bond slides, a
    new length of crack between the modes costs J (`mixed.cost_of_growth`), the crack must have grown by several zone
    lengths, and energy dissipated by friction does not count.
    """
    slopes = _slopes(scene, steps, element)
    return None if slopes is None else abs(slopes[0])


def _slopes(scene: Scene, steps: Steps, element: Callable[[], float] = lambda: nan) -> tuple[float, float] | None:
    """Slope of the dissipated energy over its expected one, less 1, and of the length of the process zone."""
    crack, slides = np.maximum.accumulate(steps["crack_length"]), simulated(scene)["shear"]
    counted = zone_is_free(scene, steps) if slides else far_from_end(scene, steps)
    counted &= crack > scene.specimen.free_length
    if not simulated(scene)["irreversible"] or not counted.any():
        return None
    cost = np.full(crack.size, scene.interface.toughness)
    if slides:
        found = mixed.cost_of_growth(scene, steps, counted)
        if found is None or not mixed.zone_has_moved(steps, counted):
            return None
        cost = found
    zone = np.maximum.accumulate(steps.get("damage_front", crack)) - crack
    crack, cost, zone = crack[counted], cost[counted], zone[counted]
    dissipated = (steps["dissipated_energy"] - steps.get("friction_energy", 0.0))[counted]
    new_crack = crack[-1] - crack[0]
    if new_crack < 5 * scene.specimen.loaded_thickness or new_crack < 3 * element():
        return None
    most, middle = float(np.max(cost)), crack + 0.5 * zone
    weight = np.gradient(middle)  # crack length per step, so that dense steps count no more than others
    spent = middle
    if np.ptp(cost) > 0.0:
        from scipy.integrate import cumulative_trapezoid  # here, as a bond that opens alone does not need it

        spent = cumulative_trapezoid(cost, middle, initial=0) / most
    from_mean = spent - np.average(spent, weights=weight)
    slope, change = (
        float(np.sum(weight * from_mean * column) / np.sum(weight * from_mean**2)) for column in (dissipated, zone)
    )
    return slope / (most * scene.specimen.width) - 1.0, change
