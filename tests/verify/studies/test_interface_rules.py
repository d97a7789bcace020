"""Lumping at the control points cures the traction of splines on a stiff interface; Lobatto points do not."""

from __future__ import annotations

import numpy as np
import pytest

from verify.methods.solve import solve
from verify.result import Result
from verify.scene.load import load_scene

#: One arm whose bond is no longer than the crack path, so that all elements along it are equal; about 260 unknowns,
#: opened to just past the peak in a few steps.
SMALL = (
    "effects.symmetry=true",
    "effects.kinematics='linear'",
    "specimen.length=6.45",
    "discretization.dofs=260",
    "discretization.steps=16",
    "load.opening=0.8",
)
STRENGTH, TOUGHNESS = 4.0, 0.1


def solved(method: str, ductility: float, rule: str = "gauss", points: int = 2) -> Result:
    """Contact is as stiff as the bond is at first."""
    stiffness = STRENGTH**2 * ductility / (2.0 * TOUGHNESS)
    keys = {"interface.ductility": ductility, "interface.penalty": stiffness}
    keys |= {"discretization.interface_rule": f"'{rule}'", "discretization.interface_points": points}
    return solve(load_scene("dcb-czm1", [*SMALL, *(f"{key}={value}" for key, value in keys.items())]), method)


def oscillation(result: Result, exact: Result) -> float:
    """RMS over the snapshots of the total variation of the traction beyond one rise and one dip, over the strength;
    what the beam's own has is no oscillation."""

    def excess(traction_q: np.ndarray) -> float:
        p = np.concatenate([[0.0], traction_q, [0.0]])
        return float(np.abs(np.diff(p)).sum() - 2.0 * np.ptp(p)) / STRENGTH

    pairs = zip(result.snapshots, exact.snapshots, strict=False)
    beyond = [max(excess(own.traction_q) - excess(beam.traction_q), 0.0) for own, beam in pairs]
    return float(np.sqrt(np.mean(np.square(beyond))))


@pytest.mark.parametrize(("ductility", "stiff"), [(12.5, False), (50_000.0, True)])
def test_lumping_cures_splines_on_a_stiff_interface_and_nothing_is_ill_on_a_soft_one(ductility, stiff):
    """A stiff law couples the openings of neighbouring points through their common functions, and the traction ahead of
    the crack alternates (Vignollet, May, de Borst 2015)."""
    beam = solved("beam", ductility)
    rules = (("gauss", 2), ("lobatto", 4), ("lumped", 2))
    gauss, lobatto, lumped = (oscillation(solved("nurbs", ductility, *rule), beam) for rule in rules)
    assert min(gauss, lobatto) > 1.0 and lumped < 0.05 * gauss if stiff else max(gauss, lobatto, lumped) < 0.02
