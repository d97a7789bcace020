"""Pressures against closed forms: a flat patch across meshes that do not match, and a cylinder on a plane (Hertz)."""

import numpy as np
import pytest
from knots import insert_knot
from plane_elasticity import Fixed, bulk_bases, prescribed, symmetry, together, traction_forces
from pressed import loose, press

from iga.bases.bspline import open_knots
from iga.bases.lagrange import lagrange_rectangle
from iga.bases.nurbs import nurbs_mesh, nurbs_rectangle
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


#: Radius of the cylinder, and half the breadth of contact for which the mesh is made.
RADIUS, BREADTH = 1.0, 0.05


def cylinder(elements: int) -> Mesh:
    """A quarter of a ring with its lowest point at the origin; exact circles, fine towards that point.

    ``elements`` on half of the breadth of contact, as many on the next, then ever longer.
    """
    near = np.linspace(0.0, 2.0, 2 * elements + 1) * BREADTH
    reach = np.concatenate([near, near[-1] + np.cumsum((near[1] - near[0]) * 1.4 ** np.arange(1, 40))])
    kv_s, T = open_knots(np.array([0.0, 1.0]), 2), np.eye(3)
    along = reach / np.sqrt(2.0)  # the arc runs that fast at its ends
    for x in along[(along > 0.0) & (along < 0.9)]:
        kv_s, step = insert_knot(kv_s, 1.0 - x)
        T = step @ T
    w_s = np.array([1.0, np.sqrt(0.5), 1.0])
    homogeneous = T @ np.column_stack([np.array([[1.0, 0.0], [1.0, -1.0], [0.0, -1.0]]) * w_s[:, None], w_s])
    w, arc = homogeneous[:, 2], homogeneous[:, :2] / homogeneous[:, 2:]
    inner = (RADIUS - reach[(reach > 0.0) & (reach < 0.6)])[::-1]
    kv_t = open_knots(np.concatenate([[0.3], inner, [RADIUS]]), 2)
    P_AI = (kv_t.greville[:, None, None] * arc + [0.0, RADIUS]).reshape(-1, 2)
    return nurbs_mesh(kv_s, kv_t, P_AI, np.tile(w, kv_t.functions))


def hertz(elements: int, points: int, slave: int, penalty: float = 100.0, approach: float = 6e-3):
    """Places x_q, what was found there, and half the breadth and the largest pressure of Hertz for the same force."""
    arc, length = cylinder(elements), 1.37 * BREADTH / elements
    breaks = np.concatenate([length * np.arange(2.5 * elements), [0.3, 0.6]])
    flat = nurbs_rectangle(open_knots(breaks, 2), open_knots(np.array([-0.1, 0.0]), 2))
    interface = loose(slave, (arc, flat), ("top", "top"), penalty * E / RADIUS * elements, points, stays=False)
    down = prescribed(arc, (arc.chains["left"],), lambda X: np.stack([0.0 * X[..., 0], 0.0 * X[..., 1] - approach], -1))
    down = Fixed(down.dof_d[down.dof_d % 2 == 1], down.value_d[down.dof_d % 2 == 1])
    rigid = Fixed(2 * len(arc.P_AI) + np.arange(flat.P_AI.size), np.zeros(flat.P_AI.size))
    fixed = together(down, symmetry(arc, arc.chains["right"]), rigid)
    # from the whole cylinder moved down: too much touches then, and Newton lets it go
    start_d = np.concatenate([np.tile([0.0, -approach], len(arc.P_AI)), np.zeros(flat.P_AI.size)])
    found = press(interface, (arc, flat), (STRAIN, STRAIN), np.zeros(start_d.size), fixed, start_d)
    force = 2.0 * float(found.p_q @ interface.dA_q)
    a = np.sqrt(4.0 * force * RADIUS * (1.0 - NU**2) / (np.pi * E))
    return interface.X_qi[:, 0], found, a, 2.0 * force / (np.pi * a)


@pytest.mark.slow
@pytest.mark.parametrize("slave", [0, 1])
def test_pressures_of_a_cylinder_on_a_rigid_plane(slave):
    """Hertz (1882): ``p = p0 sqrt(1 - x^2 / a^2)``, ``a^2 = 4 P R (1 - nu^2) / (pi E)``, ``p0 = 2 P / (pi a)``.

    The penalty grows with the number of elements: contact gives by 5.5, 2.8 and 1.4 % of the depth of the cap. At the
    edge of contact the pressure has a vertical tangent, and the error in L2 falls more slowly than the elements. The
    cylinder is exact: its sides are rational.
    """
    errors, inside = [], []
    for elements in (4, 8, 16):
        x_q, found, a, p0 = hertz(elements, 3, slave)
        exact_q, dA_q = p0 * np.sqrt(np.maximum(1.0 - (x_q / a) ** 2, 0.0)), found.interface.dA_q
        assert np.all(found.p_q >= 0.0) and found.p_q.max() < 1.03 * p0
        assert a == pytest.approx(BREADTH, rel=0.02)
        assert abs(x_q[found.p_q > 0.0].max() - a) < BREADTH / elements
        errors.append(np.sqrt(dA_q @ (found.p_q - exact_q) ** 2 / (dA_q @ exact_q**2)))
        inside.append(np.abs(found.p_q - exact_q)[x_q < 0.8 * a].max() / p0)
    print(f"slave {slave}: pressures in L2 {np.round(errors, 4)}, within 0.8 a {np.round(inside, 4)}")
    assert errors[0] < 0.06 and errors[-1] < 0.03 and errors[-1] < 0.6 * errors[0]
    assert inside[-1] < 0.035
