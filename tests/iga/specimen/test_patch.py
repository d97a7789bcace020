"""Dead tractions on patches: what is conjugate to them, and its derivative along the specimen."""

from dataclasses import replace

import numpy as np
import pytest
from bent_specimens import ARM, flexure

from iga.delamination.meshes import drawn
from iga.specimen.body import bodies
from iga.specimen.layout import Load, Support
from iga.specimen.patch import PatchRows, patch_rows
from iga.specimen.problem import Debonding

THIN = replace(ARM, thickness=0.9)
#: Patches, and where their middle is: X and Y.
PATCHES = {
    "on top": (Load(0, "top", -1.0, (50.5, 51.5)), (51.0, 1.56)),
    "within an element": (Load(0, "top", -1.0, (50.5, 50.6)), (50.55, 1.56)),
    "over many elements": (Load(0, "top", -1.0, (7.3, 81.1)), (44.2, 1.56)),
    "at an end, over it": (Load(0, "top", -1.0, (-0.5, 0.5)), (0.25, 1.56)),
    "all of a side": (Load(1, "bottom", 1.0), (51.0, -0.9)),
    "below": (Support(1, "bottom", (101.5, 102.0)), (101.75, -0.9)),
    "an end face": (Load(0, "left", 1.0), (0.0, 0.78)),
    "both end faces": (Support(None, "right"), (102.0, 0.33)),
}
COUPLES = {
    "of the upper arm": (Load(0, "left", 1.0, couple=True), (0.0, 0.78)),
    "of the lower arm": (Load(1, "left", 1.0, couple=True), (0.0, -0.45)),
    "of both arms": (Support(None, "right", couple=True), (102.0, 0.33)),
}
bases = pytest.mark.parametrize("basis", ["nurbs", "lagrange", "tspline"])


def rows_of(problem: Debonding, patch: Load | Support) -> tuple[PatchRows, np.ndarray]:
    """The rows of a patch, and the places (n_A, 2) of all control points in the specimen's own frame."""
    D = ARM.moduli.stiffness(problem.plane)
    parts = bodies(drawn(problem).meshes, (D, D), problem.pose, problem.width, True)
    P_AI = np.concatenate([part.mesh.P_AI for part in parts])
    return patch_rows(parts, patch, problem.pose, P_AI.size), problem.pose.own(P_AI)


def specimen(basis: str) -> Debonding:
    pose = {"angle": -20.0, "mirror": True, "shift": (9.0, -4.0)}
    return flexure(basis=basis, bodies=(ARM, THIN), dofs=700, mismatch=1.37, **pose)


@bases
@pytest.mark.parametrize("patch", [*PATCHES, *COUPLES])
def test_the_mean_of_linear_fields_and_their_slope_are_exact(patch, basis, rng):
    """Across, and of an end face its turn anticlockwise about the middle of its height, ``- du_x/dY``. So of rigid
    motions: a force of one at the middle of the patch, or a moment of one without a force.

    Control points moved by a linear field move the whole body by it; along the specimen the patch feels nothing.
    """
    problem, (given, middle) = specimen(basis), {**PATCHES, **COUPLES}[patch]
    rows, X_AI = rows_of(problem, given)
    c, G = rng.standard_normal(2), rng.standard_normal((2, 2))
    u_d = ((c + X_AI @ G.T) @ problem.pose.axes_kI).ravel()
    mean, slope = (-G[0, 1], 0.0) if given.couple else (c[1] + G[1] @ middle, G[1, 0])
    assert rows.mean_d @ u_d == pytest.approx(mean, rel=1e-10, abs=1e-8)
    assert rows.slope_d @ u_d == pytest.approx(slope, rel=1e-9, abs=1e-9)
    if given.couple and basis == "lagrange":  # whose control points lie on the body: it turns by - X, falling along it
        bent_d = (np.stack([X_AI[:, 0] * X_AI[:, 1], 0.0 * X_AI[:, 0]], -1) @ problem.pose.axes_kI).ravel()
        assert rows.mean_d @ bent_d == pytest.approx(-middle[0], abs=1e-8)
        assert rows.slope_d @ bent_d == pytest.approx(-1.0, rel=1e-8)


@pytest.mark.parametrize("extent", [(-3.0, -1.0), (102.5, 104.0)])
def test_a_patch_off_its_side_is_refused(extent):
    with pytest.raises(ValueError, match="a patch must lie on the side top of its body, got"):
        rows_of(specimen("nurbs"), Load(0, "top", 1.0, extent))
