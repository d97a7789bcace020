"""Numbers of a converged point that only a sliding bond has: J-integrals, mode ratio, supports, balance of an arm."""

from __future__ import annotations

import numpy as np

from iga.interface.response import forces
from iga.laws.mixed_law import MixedLaw
from iga.path.point import Point
from iga.specimen.specimen import Specimen


def sliding(specimen: Specimen, point: Point) -> dict[str, float]:
    """Columns of a specimen whose bond slides; forces for the whole width, J-integrals by area."""
    pull, q = point.response.pull, _front(point)
    assert isinstance(pull.law, MixedLaw)
    (g, s), (K, Ks) = pull.jump_qc[q], pull.law.stiffness
    square = K * max(g, 0.0) ** 2 + Ks * s**2
    pairing = point.response.contact.pairing
    start = specimen.probe.pairing if pairing is None else pairing[specimen.beside_probe]
    at_tip = specimen.probe.contact(point.state.u_d, start).slip
    forces_r = specimen.system.spring_forces(point.state.u_d)[: len(specimen.rollers)]
    return {
        "J_loads": j_of_loads(specimen, point),
        **_of_bond(specimen, point),
        "mode_ratio": float(Ks * s**2 / square) if square > 0.0 else 0.0,
        "friction_energy": point.state.rubbed,
        "tip_slip": 0.0 if at_tip is None else float(at_tip.s_q[0]),
        **{f"support_{number}": float(force) for number, force in enumerate(forces_r, start=1)},
        **_on_upper_arm(specimen, point),
    }


def _front(point: Point) -> int:
    """The point with the largest `Response.x_q` among those whose damage grows, or else among those not broken."""
    x_q, tangent, response = point.response.x_q, point.tangent, point.response
    whole_q = response.k_q < 1.0
    among_q = tangent.growing_q if tangent.growing_q.any() else whole_q
    return int(np.argmax(np.where(among_q, x_q, -np.inf)))


def j_of_loads(specimen: Specimen, point: Point) -> float:
    """``J w = - sum F d(u_F)/dX + w int W N_X dY`` over loads, supports and end faces (Rice 1968), dead tractions."""
    system, u_d = specimen.system, point.state.u_d
    width = specimen.width
    shares = [load.share for load in specimen.layout.loads]
    forces_r = system.spring_forces(u_d)
    of_loads = point.state.load * sum(
        share * float(rows.slope_d @ u_d) for share, rows in zip(shares, specimen.loads, strict=True)
    )
    of_supports = sum(float(F * (rows.slope_d @ u_d)) for F, rows in zip(forces_r, specimen.rollers, strict=False))
    return -(of_loads + of_supports) / width - specimen.ends.energy(u_d)


def _of_bond(specimen: Specimen, point: Point) -> dict[str, float]:
    """``J = - int (p dg/dX + t ds/dX) dX``, and the part of it that comes from the slip."""
    interface, response = specimen.system.interface, point.response
    found = interface.slopes(point.state.u_d, response.contact)
    if found is None:
        return {}
    (dg_q, ds_q), dX_q = found, (1.0 if specimen.upper_is_slave else -1.0) * interface.dA_q / specimen.width
    of_slip = -float(dX_q @ (response.pull.t_q * ds_q))
    return {"J_bond": of_slip - float(dX_q @ (response.p_q * dg_q)), "J_shear": of_slip}


def _on_upper_arm(specimen: Specimen, point: Point) -> dict[str, float]:
    """Sums of all forces on the upper arm, and of their moments about the origin: zero in balance.

    Moments are those of the deformed body, with linear kinematics of the undeformed one.
    """
    system, pose, state, upper = specimen.system, specimen.pose, point.state, specimen.bodies[0].points
    of_bond_d = forces(system.interface, point.response.contact, point.response.pull, system.n_dof)
    of_springs_d = system.spring_forces(state.u_d) @ system.springs_rd
    force_Ai = pose.components(pose.vectors(state.load * system.load_d + of_springs_d - of_bond_d)[upper])
    x_Ai = specimen.places[1]
    if not system.linear:
        x_Ai = x_Ai + pose.components(pose.vectors(state.u_d)[upper])
    force_x, force_y, *_ = force_Ai.sum(0)
    moment = np.sum(x_Ai[:, 0] * force_Ai[:, 1] - x_Ai[:, 1] * force_Ai[:, 0])
    return {"arm_force_x": float(force_x), "arm_force_y": float(force_y), "arm_moment": float(moment)}
