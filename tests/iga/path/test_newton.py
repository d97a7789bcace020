"""Newton on the bordered system: how fast it converges, what it leaves where it does not, contact it must search."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from specimens import PAPER

import iga.path.newton
import iga.system.system
from iga.bases.names import BASES
from iga.dcb import build
from iga.laws.laws import ShapedLaw
from iga.path.control import Prescribed, load_control, opening_control
from iga.path.follow import PATH, follow
from iga.path.newton import Iterate, Line, _circling, _hopeless, _searched, equilibrium, residual_norm
from iga.path.point import Point
from iga.path.solver import DEFAULT, MANY_DECIDE, Solver
from iga.path.tangent import tangent
from iga.system.bulk import CondensedBulk
from iga.system.system import respond

CZM1 = replace(PAPER, opening=(0.9,), dofs=400)


def points_of(system, opening, steps=40):
    return [p for p in follow(Solver(system), (opening,), steps) if isinstance(p, Point)]


@pytest.fixture(scope="module", params=["linear", "finite"])
def peak(request):
    """A system and its points a little before and at the peak."""
    system = build(replace(CZM1, kinematics=request.param)).system
    points = points_of(system, 0.9)
    top = int(np.argmax([p.state.load for p in points]))
    return system, points[top - 2], points[top]


def test_an_error_is_squared_in_one_iteration():
    """Damage grows at several points, others touch: the error halved, a quarter is left behind one iteration.

    A tangent that lacks any term would leave half.
    """
    system = build(CZM1).system
    start, end = points_of(system, 0.6)[-3:-1]
    assert np.sum(end.tangent.growing_q) >= 2 and np.any(end.state.closed_q)

    def residuals(size):
        trial = replace(end.state, u_d=(1.0 + size) * end.state.u_d, k_q=start.state.k_q)
        return equilibrium(
            Solver(system), trial, Prescribed(opening_control(system), end.opening, end.opening)
        ).residuals

    first, second = residuals(1e-3), residuals(5e-4)
    print(f"residual norms {first}, {second}")
    assert second[0] == pytest.approx(0.5 * first[0], rel=0.02)
    assert second[1] == pytest.approx(0.25 * first[1], rel=0.02)
    assert second[2] < 0.1 * first[2] and first[2] < 1e-3 * first[1]


@pytest.mark.parametrize("excess", [1.02, 1.3])
def test_beyond_the_peak_there_is_no_equilibrium_and_nothing_is_left_behind(peak, excess):
    system, before, top = peak
    state, target = before.state, excess * top.state.load
    kept = {name: np.copy(getattr(state, name)) for name in ("u_d", "k_q", "closed_q")}
    assert equilibrium(Solver(system), state, Prescribed(load_control(system), target, target - state.load)) is None
    assert all(np.array_equal(getattr(state, name), value) for name, value in kept.items())
    response = respond(system, state, decide=False)
    assert residual_norm(system, state.load, response) <= DEFAULT.tolerance, "the state is no equilibrium any more"


def test_below_the_peak_the_load_can_be_prescribed(peak):
    """The same state and control as where there is nothing to be found: the target alone makes the difference."""
    system, before, top = peak
    target = before.state.load + 0.01 * (top.state.load - before.state.load)
    change = target - before.state.load
    found = equilibrium(Solver(system), before.state, Prescribed(load_control(system), target, change))
    assert found.state.load == pytest.approx(target, rel=1e-12) and found.residuals[-1] <= DEFAULT.tolerance
    assert np.all(found.state.k_q == before.state.k_q), "history is committed by whoever accepts the step"


@pytest.mark.parametrize("kinematics", ["linear", "finite"])
def test_stiff_contact_is_found_where_full_steps_go_round_in_circles(kinematics, monkeypatch):
    """All points touch at once and the rates at the start do not say which open: steps must be measured."""
    x, h = np.linspace(0.0, CZM1.length, 40 + 1), CZM1.arm_thickness
    arms = tuple(BASES["nurbs"].rectangle((3, 3), x, np.array([y, y + h])) for y in (0.0, -h))
    system = build(replace(CZM1, precrack=x[11], kinematics=kinematics, penalty=1e8, meshes=arms)).system
    start, law = system.start(), system.interface.law
    path = tangent(Solver(system), start, respond(system, start, decide=False), 1.0, turning=True)
    trifle = PATH.ahead * law.g_max
    away = trifle / float(system.load_d @ path.du_d)
    trial = replace(start, u_d=away * path.du_d, load=away * path.d_load)

    def search():
        return equilibrium(Solver(system), trial, Prescribed(opening_control(system), trifle, trifle), MANY_DECIDE)

    found = search()
    assert found is not None and found.residuals[-1] <= MANY_DECIDE.tolerance
    response = respond(system, found.state, decide=True)
    # two points for one control point: so stiff a contact shares its forces among them as it likes, and the balance
    # hardly knows
    assert residual_norm(system, found.state.load, response) < 1e-3, "gaps and contact disagree"
    assert 0 < np.sum(found.state.closed_q) < found.state.closed_q.size
    monkeypatch.setattr(iga.path.newton, "_searched", iga.path.newton._full)
    assert search() is None, "full steps do as well: this test has nothing to say"


def test_a_search_that_goes_round_in_circles_ends():
    """As many residuals above the best one as there is patience are borne; then it ends, however it began."""
    falling = [10.0**-i for i in range(8)]
    for residuals in ([1.0], falling, [1.0, *[2.0] * DEFAULT.patience], [*falling, *[1.0] * DEFAULT.patience]):
        assert not _hopeless(residuals, DEFAULT) and _hopeless([*residuals, np.nan], DEFAULT)
    assert _hopeless([1.0, *[2.0] * (DEFAULT.patience + 1)], DEFAULT)
    assert not _hopeless([1.0, *[2.0] * (4 * DEFAULT.patience)], DEFAULT.searching)
    many = list(np.geomspace(1.0, 1e-3, DEFAULT.iterations))
    assert not _hopeless(many, DEFAULT) and _hopeless([*many, 1e-4], DEFAULT) and _hopeless([np.inf], DEFAULT)
    assert not _hopeless([*many, 1e-4, 1e-5], DEFAULT.searching)


@pytest.mark.parametrize("turn", [[2.0, 1.0], [3.0, 1.0, 2.0], [4.0, 1.0, 3.0, 2.0]])
def test_iterates_that_come_back_for_the_third_time_go_round(turn):
    assert _circling([9.0, *turn * 3]) and not _circling(turn * 2)
    assert not _circling([9.0, *turn, *turn, *(1.0001 * np.array(turn))])


def along(force, start):
    """A system of one unknown whose residual along the step is a function of how far it goes; where it was asked."""
    asked = []

    class Along(Line):
        def at(self, s):
            asked.append(s)
            return made(force(s))

    def made(residual):
        response = SimpleNamespace(internal_d=np.array([residual, 7.0]))
        return Iterate(SimpleNamespace(load=2.0), response, abs(residual))

    solver = SimpleNamespace(system=SimpleNamespace(free_d=np.array([True, False]), load_d=np.zeros(2)))
    return _searched(Along(solver, made(start), np.ones(3), True), DEFAULT).norm, asked


@pytest.mark.parametrize("stiffening", [1.0, 3.0, 20.0])
def test_a_search_ends_where_little_work_is_left(stiffening):
    """Residual -1 + s + c s^3: the whole step goes too far, and the energy is lowest where it vanishes."""

    def force(s):
        return -1.0 + s + stiffening * s**3

    left, asked = along(force, -1.0)
    assert asked[0] == 1.0 and left == abs(force(asked[-1])) and all(0.0 < s <= 1.0 for s in asked)
    assert -0.5 <= force(asked[-1]) <= DEFAULT.slack and len(asked) < 10
    assert all(not -0.5 <= force(s) <= DEFAULT.slack for s in asked[:-1]), "it stops as soon as that is so"
    assert asked[1] == pytest.approx(1.0 / (1.0 + stiffening)), "first where the line through both ends vanishes"


def test_a_gap_worth_no_force_leaves_contact_as_it_was():
    """Its sign is rounding: 1e-13 of the forces in play, 100, by the stiffer of penalty and law on an area of 0.5."""
    g_q = np.array([1.9e-12, -1.9e-12, 2.1e-12, -2.1e-12, 0.0])
    before_q = np.array([True, False, True, False, True])
    for law in (ShapedLaw.opening(2.0, 2.0, 2.0, penalty=10.0), ShapedLaw.opening(2.0, 0.4, 2.0, penalty=2.0)):
        assert {law.penalty, *law.stiffness} == {2.0, 10.0}
        system = SimpleNamespace(interface=SimpleNamespace(law=law, dA_q=np.full(5, 0.5)))
        touch, trial = SimpleNamespace(g_q=g_q), SimpleNamespace(closed_q=before_q)
        assert iga.system.system._closed(system, touch, trial, 100.0).tolist() == [True, False, False, True, True]


@pytest.mark.parametrize("kinematics", ["finite", "linear"])
def test_displacements_are_rounded_as_they_are_stored_however_little_they_strain(kinematics):
    """A body moved as a whole: changes of half a rounding make forces, which the estimate bounds, not too widely."""
    bulk = build(replace(PAPER, kinematics=kinematics)).system.bulk
    u_d = np.full(2 * (1 + max(conn_ea.max() for conn_ea in bulk.connectivity)), 7.0)
    half = 0.5 * np.finfo(float).eps * np.random.default_rng(1).uniform(-1.0, 1.0, u_d.size)
    seen = np.linalg.norm(bulk.respond(u_d * (1.0 + half)).internal_d)
    print(f"seen {seen:.2e}, estimated {bulk.rounding(u_d):.2e}")
    assert seen < bulk.rounding(u_d) < 20.0 * seen


def test_of_a_condensed_bulk_forces_that_rounding_hides_are_none():
    """Moved as a whole it exerts none, and the scale is what its unknowns hold against each other, 6e6, times
    ten roundings over the least tolerance.
    """
    small, u_d, held, eps = (
        CondensedBulk(3e6 * np.array([[1.0, -1.0], [-1.0, 1.0]])),
        np.ones(2),
        6e6,
        np.finfo(float).eps,
    )
    found = small.respond(u_d)
    assert not found.internal_d.any() and found.energy == 0.0
    assert found.scale == pytest.approx(10.0 * eps / 5e-12 * held)
    assert small.rounding(u_d) == pytest.approx(10.0 * eps * held)
    found = small.respond(np.array([0.0, 2.0]))
    assert found.internal_d.tolist() == [-6e6, 6e6] and found.energy == 6e6
    assert found.scale == pytest.approx(6e6 * np.sqrt(2.0))
