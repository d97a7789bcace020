"""The complete tangent of a system whose bond opens, slides and rubs, as it is assembled, against differences."""

from dataclasses import replace

import numpy as np
import pytest
from bent_specimens import flexure

from iga.delamination.solution import build
from iga.laws.laws import ShapedLaw
from iga.laws.mode_ratio import ModeRatio
from iga.path.solver import Solver
from iga.specimen.layout import Load, Moduli, Rectangle, Support
from iga.specimen.specimen import Specimen
from iga.system.state import Response, State
from iga.system.system import SCALES, System, respond
from tests.iga.algebra.test_factors import dense_tangent
from tests.iga.interface.test_gpts import Rig, bent

#: Bodies that are softer than the bond, so that its part of the tangent is the larger one; unequal stiffness.
ARM = Rectangle(6.0, 0.5, Moduli(E1=10.0, E2=9.0, G12=3.0, nu12=0.2))
MODES = ModeRatio((0.4, 0.9), (4.0, 6.0), (80.0, 700.0), "bk", 2.0, "turon")
SOFT = {
    "bodies": (ARM, ARM),
    "bonded": (2.0, 6.0),
    "supports": (Support(1, "bottom", (0.0, 0.25)), Support(1, "bottom", (5.75, 6.0))),
    "loads": (Load(0, "top", -1.0, (2.75, 3.25)),),
    "opening": (1.0,),
    "mismatch": 1.37,
    "width": 1.0,
}

#: Gap, slip, bend and angle of a state.
STATES = {
    "open": (0.02, 0.01, 0.2, 70.0),
    "pressed": (-0.005, 0.01, 0.2, 70.0),
    "slid far and open": (0.01, 2.5, 0.2, -110.0),
    "slid far and pressed": (-0.01, -2.5, 0.2, 10.0),
}


def moved(specimen: Specimen, state: str, rng) -> State:
    """A state of the system in which points are whole, have softened or failed, and friction has gone its own way."""
    system, interface = specimen.system, specimen.system.interface
    start, upper_A = system.start(), np.arange(len(interface.P_AI)) < len(specimen.bodies[0].mesh.P_AI)
    u_d = bent(Rig(interface, upper_A), *STATES[state], rng)
    touch = interface.contact(u_d, interface.pairing)
    k_q = np.where(interface.bonded_q, rng.choice([0.0, 0.3, 0.9], interface.points), 1.0)
    slip_q = None if start.slip_q is None else touch.slip.s_q + 1e-3 * rng.uniform(-1.0, 1.0, interface.points)
    return replace(start, u_d=u_d, k_q=k_q, slip_q=slip_q, pairing=touch.pairing, closed_q=touch.g_q < 0.0)


def _derivative(system: System, before: State, here: Response, rng) -> None:
    h, v_d = 1e-7, np.where(system.free_d, rng.standard_normal(system.n_dof), 0.0)
    ahead, behind = (
        respond(system, replace(before, u_d=before.u_d + part * h * v_d), decide=False) for part in (1.0, -1.0)
    )
    difference_d = (ahead.internal_d - behind.internal_d) / (2.0 * h)
    assert np.abs(dense_tangent(system, here) @ v_d - difference_d).max() < 1e-6 * np.abs(difference_d).max()
    rate_q = (ahead.x_q - behind.x_q) / (2.0 * h)
    assert np.abs(here.x_rates(v_d) - rate_q).max() < 1e-6 * np.abs(rate_q).max()


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize("slave", ["upper", "lower"])
@pytest.mark.parametrize(
    ("basis", "kinematics"), [("nurbs", "finite"), ("tspline", "finite"), ("lagrange", "finite"), ("nurbs", "linear")]
)
def test_the_assembled_tangent_and_what_drives_damage_are_derivatives(basis, kinematics, slave, friction, state, rng):
    """A point that has slid over sides of the master names the unknowns that these share more than once."""
    law = ShapedLaw(MODES, 5e3, friction=friction)
    specimen = build(flexure(**SOFT, bond=law, basis=basis, kinematics=kinematics, slave=slave, dofs=500))
    system, before = specimen.system, moved(specimen, state, rng)
    _derivative(system, before, respond(system, before, decide=False), rng)


def test_faces_that_have_slid_far_and_only_press_need_no_way_along_the_master_and_a_narrow_band(rng):
    """Numbered by where faces touch now: as wide a band as at rest, and the tangent is still the derivative."""
    specimen = build(flexure(**SOFT, bond=ShapedLaw(MODES, 5e3), kinematics="finite", dofs=1000))
    free = replace(specimen.system.interface, bonded_q=np.zeros(specimen.system.interface.points, dtype=bool))
    specimen = replace(specimen, system=replace(specimen.system, interface=free))
    system, before = specimen.system, moved(specimen, "slid far and pressed", rng)
    here = respond(system, before, decide=False)
    pattern = system.pattern(here)
    assert pattern.dof_qd.shape[1] == here.contact.on_master.dof_qd.shape[1] < here.contact.dof_qd.shape[1]
    assert pattern.band.k < 1.5 * system.band.k < 0.5 * system.band.reach(here.contact.dof_qd)
    _derivative(system, before, here, rng)


def test_faces_that_have_slid_too_far_end_an_attempt(rng, monkeypatch):
    """The memory of their tangent would have no bound."""
    specimen = build(flexure(**SOFT, bond=ShapedLaw(MODES, 5e3), kinematics="finite", dofs=500))
    here = respond(specimen.system, moved(specimen, "open", rng), decide=False)
    assert Solver(specimen.system).factorise(here) is not None
    monkeypatch.setattr("iga.system.system.SCALES", replace(SCALES, coupled=1.0))
    assert Solver(specimen.system).factorise(here) is None


def test_a_load_on_a_long_side_is_held_at_one_point():
    """However many elements it lies on."""
    for dofs in (500, 4000):
        system = build(flexure(**SOFT, bond=ShapedLaw(MODES, 5e3), kinematics="finite", dofs=dofs)).system
        assert np.count_nonzero(system.hold_d) == 1 < np.count_nonzero(system.load_d)
        assert np.array_equal(system.hold_d[system.hold_d != 0.0], [system.load_d.min()])
