"""Solids: what the plane has in common with them, exactly, and what their three directions add."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from bent_specimens import ARM, MODES, flexure, mixed_bending

from iga.delamination.arms import lines
from iga.delamination.meshes import drawn
from iga.delamination.problem import Problem
from iga.delamination.solution import build, solve
from iga.elements.elasticity import isotropic, solid
from iga.elements.kinematics import KINEMATICS, elasticity_tensor
from iga.laws.laws import LAWS, ShapedLaw
from iga.path.follow import follow
from iga.path.point import Point
from iga.path.solver import Solver
from iga.run import Solution
from iga.specimen.layout import OPENED, Load, Moduli, Rectangle, Support
from iga.specimen.solid import breaks_across
from iga.system.system import respond
from tests.iga.algebra.test_factors import dense_tangent, growing

#: Openings at which curves are compared: before growth, at the peak, and beyond it.
STOPS = (0.3, 0.5, 0.7)
ORTHOTROPIC = Moduli(E1=120.0, nu12=0.3, E2=10.0, G12=5.0, nu23=0.4, E3=8.0, nu13=0.25, G13=4.0, G23=3.0)

of_kinematics = pytest.mark.parametrize("kinematics", KINEMATICS)


def dcb(plane: str, nu: float = 0.3, law: str = "bilinear", **changes: object) -> Problem:
    """A stocky specimen whose bond breaks over a few elements."""
    arm = Rectangle(8.0, 1.0, Moduli(E1=120.0, nu12=nu))
    keys = {
        "bodies": (arm, arm),
        "bonded": (3.0, 8.0),
        "bond": LAWS[law].opening(0.1, 0.02, 3.0, 3.0),
        "loads": OPENED,
        "opening": (0.7,),
        "plane": plane,
        "width": 2.0,
        "symmetry": True,
        "degree": 2,
        "element": 0.5,
        "interface_points": 3,
        "steps": 6,
        "elements_width": 2 if plane == "solid" else None,
        "snapshot_openings": STOPS,
    }
    return Problem(**{**keys, **changes})


def at_stops(found: Solution) -> np.ndarray:
    assert found.status == "complete"
    return np.array([found.load[np.argmin(np.abs(found.opening - stop))] for stop in STOPS])


@of_kinematics
@pytest.mark.parametrize("law", ["bilinear", "trapezoidal", "exponential-softening"])
@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_a_solid_whose_sides_are_held_or_do_not_contract_is_the_plane(kinematics, law, plane):
    """Held sides are plane strain; without contraction plane stress, plane strain and solid are one."""
    nu, lateral = (0.3, "held") if plane == "strain" else (0.0, "free")
    flat = dcb(plane, nu, law, kinematics=kinematics)
    mesh = drawn(flat).meshes
    one = solve(replace(flat, meshes=mesh))
    other = solve(dcb("solid", nu, law, kinematics=kinematics, meshes=mesh, lateral=lateral))
    assert at_stops(other) == pytest.approx(at_stops(one), rel=1e-8, abs=0.0)
    assert other.dofs == one.dofs * 3 // 2 * 4 and other.elements == 2 * one.elements
    last = other.rows[-1]
    assert last["front_middle"] == pytest.approx(last["front_edge"]) == pytest.approx(one.rows[-1]["crack_length"])
    assert other.snapshots[-1].front_G == pytest.approx(np.full(6, last["J_bond"]))


def reached(problem: Problem, opening: float) -> tuple[object, Point]:
    system = build(problem).system
    points = [item for item in follow(Solver(system), (opening,), problem.steps) if isinstance(item, Point)]
    return system, points[-1]


@of_kinematics
def test_the_tangent_is_the_derivative_of_the_forces(kinematics, rng):
    arm = Rectangle(8.0, 1.0, ORTHOTROPIC)
    system, point = reached(dcb("solid", bodies=(arm, arm), kinematics=kinematics, snapshot_openings=()), 0.7)
    assert (point.state.k_q > system.interface.law.g_max).any()
    state = growing(point.state)
    K = dense_tangent(system, respond(system, state, decide=False))
    v_d = np.where(system.free_d, rng.standard_normal(system.n_dof), 0.0)
    h = 1e-7 / np.abs(v_d).max()
    low, high = (
        respond(system, replace(state, u_d=state.u_d + sign * h * v_d), decide=False).internal_d for sign in (-1, 1)
    )
    quotient = np.where(system.free_d, (high - low) / (2.0 * h), 0.0)
    assert np.linalg.norm(K @ v_d - quotient) < 1e-6 * np.linalg.norm(quotient)


@of_kinematics
def test_work_and_forces_are_in_balance_and_the_bond_takes_up_what_the_loads_release(kinematics):
    """At every step, with sides that are free and a front that is not straight."""
    arm = Rectangle(8.0, 1.0, replace(ORTHOTROPIC, nu13=0.6, nu23=0.2))
    found = solve(
        dcb("solid", bodies=(arm, arm), kinematics=kinematics, width=6.0, element=0.25, steps=40, opening=(1.6,))
    ).steps
    assert np.ptp(found["front_middle"]) > 0.3
    assert (found["front_middle"] > found["front_edge"] + 0.02)[found["front_edge"] > 3.1].all()
    energy = found["stored_energy"] + found["dissipated_energy"]
    assert found["external_work"] == pytest.approx(energy, rel=0.0, abs=1e-3 * energy.max())
    J = found["load"] * (found["face_slope_bottom"] - found["face_slope_top"]) / 6.0 - found["face_energy"]
    assert found["J_bond"] == pytest.approx(J, rel=0.0, abs=0.005 * J.max())
    assert found["interface_force"] == pytest.approx(found["load"], rel=1e-8, abs=1e-9)
    assert found["interface_moment"] == pytest.approx(-found["load_moment"], rel=0.0, abs=1e-7)


def test_nothing_depends_on_the_axes():
    """Turned by a right angle the stiffnesses of the material are those of other components."""
    arm = Rectangle(8.0, 1.0, ORTHOTROPIC)
    here = dcb("solid", bodies=(arm, arm))
    turned = solve(replace(here, angle=90.0, shift=(3.0, -2.0)))
    assert at_stops(turned) == pytest.approx(at_stops(solve(here)), rel=1e-10, abs=0.0)
    across = turned.snapshots[-1].front_z
    assert len(across) == 6 and np.all(np.diff(across, prepend=0.0, append=1.0) > 0.0), "points of half of the width"


def test_the_material_of_a_solid():
    """The plane ones are parts of it: plane strain its block, plane stress the block of its compliance."""
    D = solid((120.0,) * 3, (0.3,) * 3, (120.0 / 2.6,) * 3)
    assert elasticity_tensor(D)[:2, :2, :2, :2] == pytest.approx(elasticity_tensor(isotropic(120.0, 0.3, "strain")))
    D = ORTHOTROPIC.stiffness("solid")
    across = np.linalg.inv(np.linalg.inv(D)[:2, :2])
    flat = replace(ORTHOTROPIC, E3=None, nu13=None, G13=None, G23=None).stiffness("stress")
    assert across == pytest.approx(flat[:2, :2]) and np.diag(D)[3:] == pytest.approx([3.0, 4.0, 5.0])
    least = Moduli(E1=120.0, nu12=0.3, E2=10.0, G12=5.0).stiffness("solid")
    swapped = [0, 2, 1, 3, 5, 4]
    assert least[np.ix_(swapped, swapped)] == pytest.approx(least), "the third direction is like the second"


def test_elements_across_are_shorter_towards_the_edge():
    lengths = np.diff(breaks_across(dcb("solid", width=12.0, elements_width=None)))
    assert lengths.sum() == pytest.approx(6.0) and lengths[-1] <= 0.5 and (np.diff(lengths) < 0.0).all()
    assert len(breaks_across(dcb("solid", width=0.2, elements_width=None))) == 2


def test_elements_of_a_solid_grow_away_from_the_path_up_to_two_thicknesses():
    problem = dcb("solid", bonded=(12.0, 40.0), bodies=(Rectangle(40.0, 1.0, ORTHOTROPIC),) * 2, element=0.1)
    lengths = np.diff(lines(problem, 10))
    assert lengths.sum() == pytest.approx(40.0) and 1.5 < lengths.max() <= 2.0 + 1e-9
    assert np.abs(np.log(lengths[1:] / lengths[:-1])).max() < np.log(1.6)
    given = lines(replace(problem, element=None, dofs=4000), 10)
    assert np.diff(given).max() < 1.0 < lengths.max(), "of given unknowns as in the plane"


def bent(made: Callable[..., Problem], plane: str, **changes: object) -> Problem:
    """A short specimen between rollers, whose bond slides; the lever of mixed bending opens it as well."""
    arm = replace(ARM, length=24.0)
    rollers = Support(1, "bottom", (0.0, 0.5)), Support(1, "bottom", (23.5, 24.0))
    keys = {"bodies": (arm, arm), "bonded": (8.0, 24.0), "supports": rollers, "opening": (0.4,), "element": 0.5}
    more = {"width": 4.0, "plane": plane, "interface_points": 4, "elements_width": 1 if plane == "solid" else None}
    down, up = (11.5, 12.5), (0.0, 0.5)
    loads = {
        flexure: (Load(0, "top", -1.0, down),),
        mixed_bending: (Load(0, "top", -2.0, down), Load(0, "top", 1.0, up)),
    }
    return made(**{**keys, **more, "loads": loads[made], "steps": 6, **changes})


@pytest.mark.parametrize(
    ("made", "kinematics", "plane"),
    [
        pytest.param(flexure, "linear", "strain", marks=pytest.mark.slow),
        (mixed_bending, "linear", "strain"),
        pytest.param(mixed_bending, "finite", "strain", marks=pytest.mark.slow),
        (mixed_bending, "finite", "stress"),
    ],
)
def test_bodies_that_slide_and_are_held_or_do_not_contract_are_plane(
    made: Callable[..., Problem], kinematics: str, plane: str
) -> None:
    """Steps end elsewhere, over which the dissipation is summed; the rest does not depend on them."""
    nu, lateral = (ARM.moduli.nu12, "held") if plane == "strain" else (0.0, "free")
    arm = replace(ARM, length=24.0, moduli=replace(ARM.moduli, nu12=nu))
    keys = {"bodies": (arm, arm), "kinematics": kinematics, "snapshot_openings": (0.2, 0.3)}
    flat = bent(made, plane, **keys)
    mesh = drawn(flat).meshes
    one = solve(replace(flat, meshes=mesh))
    other = solve(replace(bent(made, "solid", lateral=lateral, **keys), meshes=mesh))
    assert one.status == other.status == "complete" and one.rows[-1]["damage_front"] > 9.0
    for stop in (0.2, 0.3, 0.4):
        here, there = (found.rows[int(np.argmin(np.abs(found.opening - stop)))] for found in (one, other))
        for name in ("load", "J_bond", "J_loads", "J_shear", "mode_ratio", "tip_slip"):
            assert there[name] == pytest.approx(here[name], rel=1e-8), name
        assert there["support_1"] == pytest.approx(here["support_1"], rel=1e-8, abs=1e-8 * here["load"])
        assert there["dissipated_energy"] == pytest.approx(here["dissipated_energy"], rel=1e-4)


@of_kinematics
def test_the_slip_of_a_free_width_is_a_vector_and_its_tangent_the_derivative(kinematics: str, rng: np.random.Generator):
    """At random displacements, where points slide along the specimen and across it, and at rest."""
    system = build(bent(flexure, "solid", bond=ShapedLaw(MODES, 5e3), kinematics=kinematics)).system
    v_d = np.where(system.free_d, rng.standard_normal(system.n_dof), 0.0)
    for size in (1e-3, 0.0):
        state = replace(system.start(), u_d=size * np.where(system.free_d, rng.standard_normal(system.n_dof), 0.0))
        state = replace(state, closed_q=respond(system, state).closed_q)
        here = respond(system, state, decide=False)
        assert (here.k_q[system.interface.bonded_q] > 0.0).any() == (size > 0.0)
        low, high = (
            respond(system, replace(state, u_d=state.u_d + h * v_d), decide=False).internal_d for h in (-1e-9, 1e-9)
        )
        off_d = dense_tangent(system, here) @ v_d - (high - low) / 2e-9
        assert np.linalg.norm(off_d[system.free_d]) < 1e-6 * np.linalg.norm((high - low)[system.free_d] / 2e-9)


@pytest.mark.parametrize(
    ("made", "kinematics", "opening"),
    [(flexure, "linear", 0.25), pytest.param(mixed_bending, "finite", 0.4, marks=pytest.mark.slow)],
)
def test_work_and_j_of_bodies_that_slide_on_a_free_width(
    made: Callable[..., Problem], kinematics: str, opening: float
) -> None:
    """Sides contract differently, so that points slide across the specimen as well. J is that of a coarse mesh: in the
    bending test it is 12 % off before there is damage, and less once there is a zone."""
    arm = replace(ARM, length=24.0, moduli=replace(ARM.moduli, nu13=0.6, nu23=0.2))
    keys = {"bodies": (arm, arm), "width": 12.0, "elements_width": 2, "kinematics": kinematics}
    keys |= {"opening": (opening,), "steps": 3}
    found = solve(bent(made, "solid", **keys)).steps
    assert found["dissipated_energy"][-1] > 0.0
    energy = found["stored_energy"] + found["dissipated_energy"]
    assert found["external_work"] == pytest.approx(energy, rel=0.0, abs=1e-3 * energy.max())
    assert found["J_bond"] == pytest.approx(found["J_loads"], rel=0.0, abs=0.025 * found["J_loads"].max())
    for name in ("arm_force_x", "arm_force_y", "arm_moment"):
        assert np.abs(found[name]).max() < 1e-7 * np.abs(found["load"]).max()
