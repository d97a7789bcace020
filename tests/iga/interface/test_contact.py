"""Pressures against closed forms: a flat patch across meshes that do not match, and a cylinder on a plane (Hertz)."""

import numpy as np
import pytest
from plane_elasticity import Fixed, bulk_bases, symmetry, together, traction_forces
from pressed import loose, press

from iga.bases.bspline import open_knots
from iga.bases.lagrange import lagrange_rectangle
from iga.bases.nurbs import nurbs_rectangle
from iga.elements.elasticity import orthotropic
from iga.elements.kinematics import elasticity_tensor
from iga.mesh.extraction import Mesh

E, NU = 1000.0, 0.3
STRESS, STRAIN = (orthotropic(E, E, E / (2.0 * (1.0 + NU)), NU, plane) for plane in ("stress", "strain"))


def block(basis: str, degree: int, elements: int, through: tuple[float, float]) -> Mesh:
    breaks, heights = np.linspace(0.0, 4.0, elements + 1), np.linspace(*through, 3)
    if basis == "lagrange":
        return lagrange_rectangle(breaks, heights, degree)
    return nurbs_rectangle(open_knots(breaks, degree), open_knots(heights, degree))


def shifted(fixed: Fixed, first: int) -> Fixed:
    return Fixed(fixed.dof_d + 2 * first, fixed.value_d)


def patch(basis: str, degree: int, points: int, slave: int, lower: int = 8) -> tuple[float, float]:
    """Largest deviation of the pressure at the points, and of the stress in both bodies, from the uniform one."""
    meshes = upper, below = block(basis, degree, 11, (0.0, 1.0)), block(basis, degree, lower, (-1.0, 0.0))
    interface = loose(slave, meshes, ("bottom", "top"), 100.0 * E, points, stays=True)
    f_Ai = traction_forces(upper, (upper.chains["top"],), lambda X, n: -1.0 * n)
    f_d = np.concatenate([f_Ai.ravel(), np.zeros(below.P_AI.size)])
    held = together(symmetry(below, below.chains["bottom"]), symmetry(below, below.chains["left"]))
    fixed = together(shifted(held, len(upper.P_AI)), symmetry(upper, upper.chains["left"]))
    found = press(interface, meshes, (STRESS, STRESS), f_d, fixed)
    exact = np.array([[0.0, 0.0], [0.0, -1.0]])
    worst, first, C = 0.0, 0, elasticity_tensor(STRESS)
    for mesh in meshes:
        u_Ai = found.u_d.reshape(-1, 2)[first : first + len(mesh.P_AI)]
        for bulk in bulk_bases(mesh):
            grad = np.einsum("eqIa,eai->eqiI", bulk.dN_eqIa, u_Ai[bulk.conn_ea])
            worst = max(worst, np.abs(np.einsum("ijkl,eqkl->eqij", C, grad) - exact).max())
        first += len(mesh.P_AI)
    return float(np.abs(found.p_q - 1.0).max()), float(worst)


#: By basis and degree: the worst stress of both slaves with 2 and with 12 points a side, in parts of the pressure.
PATCH = {
    ("nurbs", 2): (0.04, 1e-4),
    ("nurbs", 3): (0.03, 1e-5),
    ("lagrange", 1): (0.01, 3e-4),
    ("lagrange", 2): (0.31, 4e-3),
}


@pytest.mark.parametrize("slave", [0, 1])
@pytest.mark.parametrize(("basis", "degree"), PATCH)
def test_flat_patch_on_meshes_that_do_not_match(basis, degree, slave):
    """Lengths 1 : 1.37. One pass of points is exact up to their integration of the master's functions.

    Derivatives of order r jump on joints that the slave's points do not see (r = p for splines, r = 1 for Lagrange
    elements), so that the error falls with n points like n^-(r + 1).
    """
    points = np.array([2, 3, 4, 6, 8, 12])
    pressure, stress = np.array([patch(basis, degree, n, slave) for n in points]).T
    rate = -np.polyfit(np.log(points), np.log(stress), 1)[0]
    order = degree + 1 if basis == "nurbs" else 2
    print(f"{basis} {degree} slave {slave}: stress {stress}, pressure {pressure}, rate {rate:.2f}, expected {order}")
    coarse, fine = PATCH[basis, degree]
    assert rate > order - 0.5 and stress[0] < coarse and stress[-1] < fine


@pytest.mark.parametrize("basis", ["nurbs", "lagrange"])
def test_flat_patch_on_meshes_that_match_is_exact(basis):
    assert max(patch(basis, 2, 3, 0, lower=11)) < 1e-9
