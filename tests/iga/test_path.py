"""The path as a whole: snap-backs, separation, unloading, closing; ledger, steps, and what rounding does to it."""

import dataclasses
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import spsolve
from specimens import PAPER

import iga.inner
import iga.path
import iga.work
from iga.cohesive import BilinearLaw
from iga.dcb import build
from iga.newton import DEFAULT, Newton, residual_norm
from iga.pace import SPARED
from iga.path import End, follow
from iga.system import respond

CZM1 = replace(PAPER, opening=(3.0,))
BOTH = [("nurbs", "finite"), ("lagrange", "linear")]
#: Defects that are known; their tests fail as soon as they are gone.


def run(problem, steps=150, **limits):
    """System, points and end of a problem's path."""
    system = build(problem).system
    *points, end = follow(system, problem.opening, steps, **limits)
    return system, points, end


def column(points, name):
    return np.array([getattr(point, name) for point in points])


def loads(points):
    return np.array([point.state.load for point in points])


def curve(points, openings):
    """Load at given openings, cubic between the points with their slopes; the path must not turn back."""
    opening, load, slope = column(points, "opening"), loads(points), column(points, "slope")
    return CubicHermiteSpline(opening, load, slope)(openings)


def decided(system, before, point):
    """Relative residual of a committed point with the history before it, contact by the signs of the gaps."""
    response = respond(system, replace(point.state, k_q=before.state.k_q), decide=True)
    return residual_norm(system, point.state.load, response)


def ledger(system, points):
    """Largest gap in the ledger over the path, in parts of what is dissipated by its end."""
    gap = column(points, "external_work") - np.array([p.energies.total for p in points])
    return float(np.max(np.abs(gap))) / points[-1].energies.dissipated


SNAPPING = [
    pytest.param(
        basis, strength, kinematics, marks=pytest.mark.slow if (strength, kinematics) == (20.0, "finite") else ()
    )
    for basis in ("nurbs", "lagrange")
    for strength in (6.0, 20.0)
    for kinematics in ("linear", "finite")
]


@pytest.mark.parametrize(("basis", "strength", "kinematics"), SNAPPING)
def test_snap_backs_are_followed(basis, strength, kinematics):
    """Zones of one element down to a tenth: the whole way, in balance, and never back in damage."""
    system, points, end = run(replace(CZM1, basis=basis, strength=strength, kinematics=kinematics))
    law = system.interface.law
    assert end.status == "complete" and not end.separated and points[-1].opening == 3.0
    assert np.any(column(points, "heading") < 0.0) and np.any(np.diff(column(points, "opening")) < 0.0)
    gap = ledger(system, points)
    residuals = [decided(system, a, b) for a, b in zip(points[:-1], points[1:], strict=True)]
    print(f"{len(points)} points, {end.rejected} taken back, ledger {gap:.1e}, residual {max(residuals):.1e}")
    assert gap < 0.01
    assert max(residuals) <= DEFAULT.settle and max(p.residuals[-1] for p in points[1:]) < 1e-9
    k_pq = np.array([p.state.k_q for p in points])
    assert np.all(np.diff(k_pq, axis=0) >= 0.0) and np.any(k_pq[-1] > law.g_u)
    assert np.all(k_pq >= np.array([p.response.contact.g_q for p in points]))
    spent = np.array([p.energies.dissipated for p in points])
    assert np.all(np.diff(spent) >= -1e-12 * spent[-1])


@pytest.mark.parametrize(("basis", "kinematics"), BOTH)
@pytest.mark.parametrize("strength", [4.0, 6.0])
def test_a_specimen_that_comes_apart_ends_the_path(basis, kinematics, strength):
    """The crack runs through the far end: back in opening, to no load, and that is told."""
    system, points, end = run(replace(CZM1, basis=basis, strength=strength, kinematics=kinematics, opening=(8.0,)))
    law, last = system.interface.law, points[-1]
    assert end.status == "complete" and end.separated
    assert last.opening < max(column(points, "opening")) < 8.0
    assert abs(last.state.load) < 1e-3 * max(loads(points))
    # it may end a hair before the last point that carries is open altogether
    whole = int(np.sum(last.state.k_q < 0.99 * law.g_u))
    spent = last.energies.dissipated / (law.toughness * float(system.interface.dA_q.sum()))
    print(f"{whole} of {last.state.k_q.size} points not broken, {spent:.3f} of the bond's toughness dissipated")
    assert whole <= 1 and ledger(system, points) < 0.01


def test_a_programme_that_unloads_to_zero_has_not_come_apart():
    """Without load, most of the bond broken; and the little that is left carries again."""
    system, points, end = run(replace(CZM1, opening=(4.3, 0.0, 1e-4, 3.0)))
    broken = points[-1].state.k_q >= system.interface.law.g_u
    assert end == End("complete", end.rejected) and points[-1].opening == 3.0
    at_zero = next(p for p in points[1:] if p.opening == 0.0)
    assert np.mean(broken) > 0.5 and abs(at_zero.state.load) < 1e-9 * max(loads(points))
    assert points[-1].state.load > 0.05 * max(loads(points))


@pytest.mark.parametrize("programme", [(1.5, 0.0), (1.5, 0.0, 0.4)])
def test_little_load_alone_is_no_separation(programme):
    _, points, end = run(replace(CZM1, opening=programme))
    assert end.status == "complete" and not end.separated and points[-1].opening == programme[-1]


def stiffness(system, closed_q, k_q):
    """Matrix of the reference configuration with frozen damage, put together from its parts."""
    shape = (system.n_dof, system.n_dof)
    parts = [_scattered(K, d, shape) for K, d in zip(system.linear_matrices, system.element_dofs, strict=True)]
    interface, start = system.interface, system.start()
    touch = respond(system, start, decide=False).contact
    secant_q = np.where(closed_q, interface.law.penalty, interface.law.secant(k_q)) * interface.dA_q
    rows = touch.V_qrd[:, 0]
    parts.append(_scattered(secant_q[:, None, None] * rows[:, :, None] * rows[:, None, :], touch.dof_qd, shape))
    for a_d, k in zip(system.springs_rd, system.spring_r, strict=True):
        parts.append(coo_array(k * np.outer(a_d, a_d)))
    return csc_array(sum(part.tocsc() for part in parts))


def _scattered(K_eij, dofs_ei, shape):
    row, column = np.broadcast_arrays(dofs_ei[:, :, None], dofs_ei[:, None, :])
    return coo_array((K_eij.ravel(), (row.ravel(), column.ravel())), shape=shape)


def secant_slope(system, closed_q, k_q):
    """Load over opening with frozen damage, by an independent linear solve."""
    assert np.all(system.free_d)
    u_d = spsolve(stiffness(system, closed_q, k_q), system.load_d)
    return 1.0 / float(system.load_d @ u_d)


#: Openings at which the curves with and without unloading are compared, and one so small that it is none.
STOPS, NEARLY = (1.5, 1.6, 1.8, 2.0, 2.2, 2.5, 3.0), 1e-3


@pytest.fixture(scope="module", params=["linear", "finite"])
def reloaded(request):
    """There, back to nothing, there again and on; a mesh without snap-backs."""
    return run(replace(CZM1, dofs=800, kinematics=request.param, opening=(1.5, NEARLY, 0.0, *STOPS)))


def stops(points, opening):
    return [i for i, p in enumerate(points) if p.opening == opening]


def test_unloading_has_the_secant_stiffness_of_the_damage(reloaded):
    """Every slope to nearly nothing and back in linear kinematics; in finite kinematics next to no load."""
    system, points, end = reloaded
    (top, again), (nearly,), bottom = stops(points, 1.5), stops(points, NEARLY), stops(points, 0.0)[-1]
    assert end.status == "complete" and top < nearly < bottom < again
    law, worst, linear = system.interface.law, 0.0, system.kinematics == "linear"
    damage = law.damage(points[top].state.k_q)
    assert np.any(damage == 1.0) and np.any((damage > 0.0) & (damage < 1.0))
    for i in (*range(top + 1, bottom), *range(bottom + 1, again)) if linear else (nearly,):
        point = points[i]
        assert np.array_equal(point.state.k_q, points[top].state.k_q), "damage grows below what has been seen"
        exact = secant_slope(system, point.response.contact.g_q < 0.0, point.state.k_q)
        worst = max(worst, abs(point.slope / exact - 1.0))
        assert point.state.load == pytest.approx(exact * point.opening, rel=1e-6)
    print(f"{system.kinematics}: slope against independent secant {worst:.1e}")
    assert worst < 1e-6
    assert abs(points[bottom].state.load) < 1e-9 * max(loads(points))


def test_the_slope_at_no_load_is_that_of_the_way_there(reloaded):
    system, points, _ = reloaded
    (nearly,), bottom = stops(points, NEARLY), stops(points, 0.0)[-1]
    exact = secant_slope(system, points[nearly].response.contact.g_q < 0.0, points[nearly].state.k_q)
    assert points[bottom].slope == pytest.approx(exact, rel=1e-6)


def test_reloading_meets_the_curve_again(reloaded):
    """Beyond 1.5 the same loads as without having been back."""
    system, points, _ = reloaded
    _, straight, _ = run(replace(CZM1, dofs=800, kinematics=system.kinematics, opening=STOPS))
    worst = 0.0
    for opening in STOPS:
        again, alone = points[stops(points, opening)[-1]], straight[stops(straight, opening)[-1]]
        worst = max(worst, abs(again.state.load / alone.state.load - 1.0))
        assert again.energies.dissipated == pytest.approx(alone.energies.dissipated, rel=2e-3)
    print(f"{system.kinematics}: loads after reloading within {worst:.1e}")
    assert worst < 2e-3


@pytest.mark.parametrize(("basis", "kinematics"), BOTH)
def test_closing_is_held_by_contact(basis, kinematics):
    """Pressed together by 0.1 and opened again: penetration is pressure by penalty, so a tenth with ten times that."""
    deepest = []
    for penalty in (1e5, 1e6):
        problem = replace(CZM1, basis=basis, kinematics=kinematics, penalty=penalty)
        system, points, end = run(replace(problem, opening=(1.5, -0.1, 3.0)))
        assert end.status == "complete" and not end.separated and points[-1].opening == 3.0
        pressed = points[stops(points, -0.1)[0]]
        g_q, p_q = pressed.response.contact.g_q, pressed.response.p_q
        assert pressed.state.load < 0.0 and np.min(p_q) < 0.0
        broken_q = pressed.state.k_q >= system.interface.law.g_u
        assert np.any(p_q[broken_q] < 0.0), "broken points let each other through"
        assert np.all(-g_q[g_q < 0.0] <= -p_q[g_q < 0.0] / penalty * (1.0 + 1e-9))
        force = float(system.interface.dA_q @ p_q)
        assert force == pytest.approx(pressed.state.load, rel=1e-6 if kinematics == "linear" else 1e-2)
        assert ledger(system, points) < 0.01
        deepest.append(-float(np.min(g_q)))
    print(f"{basis}, {kinematics}: penetration {deepest}")
    assert deepest[0] / deepest[1] == pytest.approx(10.0, rel=0.5)


def test_a_path_that_cannot_go_on_says_why_and_keeps_what_it_has(monkeypatch):
    """Newton without an iteration: the straight elastic part needs none, the first point that softens does.

    On the gaps alone, too: else a linear bulk never needs any.
    """
    monkeypatch.setattr(iga.inner, "MOST", 0)
    problem = replace(CZM1, kinematics="linear")
    system, points, end = run(problem, 30, newton=Newton(tolerance=1e-9, iterations=0))
    _, whole, _ = run(problem, 30)
    assert end.status.startswith("stopped: ") and not end.separated and end.rejected > 10
    for told in ("Newton", f"{points[-1].opening:.6g}", "discretization.dofs", "interface.strength"):
        assert told in end.status
    assert 3 < len(points) < len(whole) and 0.0 < points[-1].opening < 0.3
    elastic = [(p.opening, p.state.load) for p in whole if p.opening <= points[-1].opening]
    kept = [(p.opening, p.state.load) for p in points[: len(elastic)]]
    assert np.allclose(kept, elastic, rtol=1e-9)
    assert all(decided(system, a, b) < DEFAULT.settle for a, b in zip(points[:-1], points[1:], strict=True))


LEAKING = [("nurbs", 4.0, "linear", 20), ("nurbs", 6.0, "finite", 20), ("lagrange", 20.0, "finite", None)]


@pytest.mark.parametrize(("basis", "strength", "kinematics", "steps"), LEAKING)
def test_no_step_leaks_energy(basis, strength, kinematics, steps, monkeypatch):
    """A step that leaps over a part of the path is taken back; each of these paths has one, were it let pass."""

    def leak():
        _, points, _ = run(replace(CZM1, basis=basis, strength=strength, kinematics=kinematics), steps)
        work, energy = column(points, "external_work"), np.array([p.energies.total for p in points])
        return float(np.max(np.abs(np.diff(work - energy)) / np.maximum.accumulate(np.abs(work))[1:]))

    guarded = leak()
    monkeypatch.setattr(iga.path, "leaks", lambda *_: False)
    loose = leak()
    print(f"largest leak {guarded:.1e}, were it let pass {loose:.1e}")
    assert guarded <= iga.work.LEAK < loose


class Rounded(BilinearLaw):
    """The bilinear law, its energy off in the last digit, so that what is not damaged dissipates by rounding."""

    def work(self, k):
        return super().work(k) * (1.0 + 4e-16)


def test_rounding_in_the_energies_does_not_refuse_the_step_on_which_damage_begins():
    system = build(CZM1).system
    law = system.interface.law
    off = replace(system, interface=replace(system.interface, law=Rounded(**dataclasses.asdict(law))))
    ends = {}
    for name, tried in (("exact", system), ("off", off)):
        *points, ends[name] = follow(tried, (0.8,), 40)
        print(f"{name}: {len(points)} points, {ends[name].rejected} rejected")
    assert points[1].energies.dissipated > 0.0 and points[-1].energies.dissipated > 0.1  # by rounding, and in truth
    assert ends["off"] == ends["exact"] == End("complete", 0)


@pytest.mark.slow
@pytest.mark.parametrize("strength", [4.0, 6.0])
def test_ledger_and_iterations_of_the_paper_s_specimens(strength):
    system, points, end = run(replace(CZM1, strength=strength, dofs=1956))
    gap, iterations = ledger(system, points), np.mean([p.iterations for p in points[1:]])
    print(f"strength {strength}: ledger {gap:.1e}, {iterations:.2f} iterations a step, {len(points) - 1} steps")
    assert end.status == "complete" and gap < 1e-3 and iterations <= 5.0


@pytest.mark.slow
def test_five_steps_and_two_thousand_draw_one_curve():
    """So weak an interface that its zone is long and the curve smooth: few points and their slopes draw it."""
    problem = replace(CZM1, kinematics="linear", dofs=800, strength=1.0)
    (_, few, end), (_, many, _) = run(problem, 5), run(problem, 2000)
    assert end.status == "complete" and np.all(column(many, "heading") > 0.0)
    opening = np.linspace(0.0, 3.0, 401)[1:]
    difference = curve(few, opening) - curve(many, opening)
    worst = float(np.linalg.norm(difference) / np.linalg.norm(curve(many, opening)))
    print(f"{len(few) - 1} and {len(many) - 1} steps: curves within {worst:.2e}")
    assert len(many) > 1900 and len(few) < 100 and worst < 2e-3


def test_the_points_of_few_steps_lie_on_the_curve_of_many():
    problem = replace(CZM1, kinematics="linear", dofs=800, opening=(1.5,))
    (_, few, end), (_, many, _) = run(problem, 5), run(problem, 1000)
    assert end.status == "complete" and np.all(column(many, "heading") > 0.0)
    worst = float(np.max(np.abs(curve(many, column(few, "opening")) - loads(few)))) / max(loads(many))
    print(f"{len(few) - 1} steps, points off the curve of {len(many) - 1} steps by {worst:.1e} of the peak")
    assert worst < 1e-3


#: Basis, strength, unknowns: neighbouring meshes, whose quadrature points break elsewhere along the curve.
MANY_ARCS = [
    ("nurbs", 4.0, 1900),
    ("nurbs", 4.0, 1956),
    ("nurbs", 4.0, 2040),
    ("nurbs", 6.0, 1956),
    ("tspline", 4.0, 1956),
]


@pytest.mark.slow
@pytest.mark.parametrize(("basis", "strength", "dofs"), MANY_ARCS)
def test_steps_chosen_by_accuracy_are_few_and_draw_the_curve(basis, strength, dofs):
    problem = replace(CZM1, basis=basis, strength=strength, dofs=dofs)
    (_, few, end), (_, many, _) = run(problem, None), run(problem, 150)
    opening = np.linspace(0.0, 3.0, 401)[1:]
    reference = np.interp(opening, column(many, "opening"), loads(many))
    error = float(np.linalg.norm(curve(few, opening) - reference) / np.linalg.norm(reference))
    print(f"{len(few) - 1} steps instead of {len(many) - 1}: curve within {error:.2e}")
    assert end.status == "complete" and len(few) - 1 <= 40 and error < 1e-3


@pytest.mark.parametrize("kinematics", ["linear", "finite"])
@pytest.mark.parametrize("basis", ["nurbs", "lagrange"])
def test_steps_chosen_by_accuracy_end_in_balance(basis, kinematics):
    system, points, end = run(replace(CZM1, basis=basis, kinematics=kinematics, dofs=800), None)
    residuals = [decided(system, a, b) for a, b in zip(points[:-1], points[1:], strict=True)]
    print(f"{basis}, {kinematics}: residual with contact by the signs of the gaps {max(residuals):.1e}")
    assert end.status == "complete" and max(residuals) <= DEFAULT.settle


def test_the_further_steps_may_leave_their_tangents_the_fewer_there_are():
    system = build(replace(CZM1, dofs=800, interface_points=4)).system
    taken = []
    for bend in (0.003, 0.03):
        *points, end = follow(system, (2.0,), None, bend=bend)
        away = [
            abs(b.state.load - a.state.load - a.slope * (b.opening - a.opening))
            for a, b in zip(points, points[1:], strict=False)
        ]
        peak = max(loads(points))
        assert end.status == "complete" and np.median(away) < bend * peak
        taken.append(len(points) - 1)
    print(f"{taken} steps")
    assert taken[1] < 0.7 * taken[0]


def test_failures_now_and_then_do_not_make_a_path_count_its_steps():
    """A coarse mesh, whose load goes up and down with its points: some steps fail, and few are needed all the same."""
    system = build(replace(CZM1, basis="nurbs", degree=2, dofs=300, interface_points=4)).system
    *points, end = follow(system, (3.0,), None, bend=0.05)
    print(f"{len(points) - 1} steps, {end.rejected} rejected")
    assert end.status == "complete" and end.rejected > SPARED and len(points) <= 40


NUMBERS = ("length", "arm_thickness", "precrack", "E1", "E2", "G12", "nu12", "strength", "toughness", "ductility")


@pytest.mark.parametrize(("basis", "kinematics"), BOTH)
def test_rounding_of_the_input_is_not_amplified(basis, kinematics, rng):
    """Every number times 1 + 1e-14 r, three times."""
    problem = replace(CZM1, basis=basis, strength=6.0, kinematics=kinematics)
    _, points, _ = run(problem)
    plain = np.stack([column(points, "opening"), loads(points)])
    moved = []
    for _ in range(3):
        names = (*NUMBERS, "penalty", "width")
        noisy = {name: getattr(problem, name) * (1.0 + 1e-14 * rng.uniform(-1.0, 1.0)) for name in names}
        opening = (3.0 * (1.0 + 1e-14 * rng.uniform(-1.0, 1.0)),)
        _, others, _ = run(replace(problem, **noisy, opening=opening))
        other = np.stack([column(others, "opening"), loads(others)])
        assert other.shape == plain.shape, "another number of steps"
        moved.append(float(np.max(np.abs(other - plain) / np.max(np.abs(plain), axis=1, keepdims=True))))
    print(f"{basis}, {kinematics}: {len(points)} points moved by {max(moved):.1e}")
    assert 0.0 < max(moved) < 1e-8


@pytest.mark.parametrize(
    ("broken", "load", "d_load", "slope", "separated"),
    [
        (0.6, 0.0, -1.0, -5.0, True),
        (0.6, 0.9e-3, -1.0, -5.0, True),
        (0.6, -0.9e-3, -1.0, -5.0, True),
        (0.6, 1.1e-3, -1.0, -5.0, False),
        (0.5, 0.0, -1.0, -5.0, False),
        (0.6, 0.0, 0.5, 5.0, False),
        (0.6, 0.0, 0.5, 0.9e-3 / 3.0, True),
        (0.6, 0.0, 0.5, -0.9e-3 / 3.0, True),
        (0.6, 0.0, 0.5, 1.1e-3 / 3.0, False),
    ],
)
@pytest.mark.parametrize("bonded", [False, True])
def test_what_has_come_apart_carries_nothing_and_will_not(broken, load, d_load, slope, separated, bonded):
    """More than half of the bond broken, no load, and none that the path brings over its reach of 3; the peak is 1."""
    k_q = np.where(np.arange(10) < 10 * broken, 2.0, 1.9)
    bonded_q, area_q = None, np.ones(10)
    if bonded:  # as many points that only touch count for nothing
        k_q, area_q, bonded_q = np.append(k_q, np.zeros(10)), np.ones(20), np.arange(20) < 10
    interface = SimpleNamespace(dA_q=area_q, bonded_q=bonded_q, law=SimpleNamespace(g_u=2.0))
    tangent = SimpleNamespace(d_load=d_load)
    point = SimpleNamespace(state=SimpleNamespace(k_q=k_q, load=load), tangent=tangent, slope=slope)
    assert iga.path._separated(SimpleNamespace(interface=interface), point, 3.0, 1.0) == separated


@pytest.mark.parametrize(
    ("programme", "way"),
    [
        ((3.0,), (3.0,)),
        ((1.5, -0.1, 3.0), (1.5, 0.0, -0.1, 0.0, 3.0)),
        ((1.5, 0.0, -0.1), (1.5, 0.0, -0.1)),
        ((-1.0, -2.0), (-1.0, -2.0)),
    ],
)
def test_a_programme_stops_wherever_it_passes_through_zero(programme, way):
    assert iga.path.by_way_of_zero(programme) == way


def test_bodies_that_nothing_holds_are_refused(monkeypatch):
    monkeypatch.setattr(iga.path, "_departing", lambda *given: None)
    with pytest.raises(ValueError, match="singular: the supports or the interface do not hold the bodies"):
        next(follow(build(CZM1).system, (1.0,), 10))


def test_a_new_mesh_that_nothing_can_be_solved_on_ends_the_path(monkeypatch):
    system, departing, asked = build(replace(CZM1, kinematics="linear")).system, iga.path._departing, []

    def once(*given):
        asked.append(given)
        return departing(*given) if len(asked) == 1 else None

    monkeypatch.setattr(iga.path, "_departing", once)
    *points, end = follow(system, (0.1,), 50, renew=lambda point: (system, point.state))
    assert end.status == "stopped: the new mesh at opening 0.1 has a singular tangent" and len(points) == 2


def test_a_path_that_leaps_however_short_the_step_is_told_what_to_do(monkeypatch):
    monkeypatch.setattr(iga.path, "leaks", lambda system, before, after, most: before.opening > 0.0)
    problem = replace(CZM1, kinematics="linear", opening=(0.1,))
    _, points, end = run(problem, 50)
    assert end.status.startswith(f"stopped: the energy jumps at opening {points[-1].opening:.6g}, however short")
    assert "discretization.dofs" in end.status and "tspline, nurbs" in end.status and end.rejected > 12


@pytest.mark.parametrize(("steps", "again"), [(None, True), (60, False)])
def test_a_shorter_step_is_foreseen_with_the_law_and_a_careful_one_along_the_tangent(steps, again, monkeypatch):
    """What the tangent was read from is read once more where steps are chosen by accuracy; it is the same."""
    known, refused, foresee, leaks = [], [], iga.path.foresee, iga.path.leaks

    def recorded(*given):
        known.append(given[4])
        return foresee(*given)

    def once(system, before, after, most):
        refuse = not refused and after.tangent.growing_q.any()
        if refuse:
            refused.append(len(known) - 1)
        return refuse or leaks(system, before, after, most)

    monkeypatch.setattr(iga.path, "foresee", recorded)
    monkeypatch.setattr(iga.path, "leaks", once)
    _, points, end = run(replace(CZM1, kinematics="linear", opening=(0.5,)), steps)
    (at,) = refused
    first, second = known[at], known[at + 1]
    assert end.rejected >= 1 and first is not None and (second is not None) == again
    if again:
        b_d = np.arange(1.0, first.response.internal_d.size + 1.0)[:, None]
        x_d = first.inverse.solve(b_d)
        assert np.abs(second.inverse.solve(b_d) - x_d).max() < 1e-9 * np.abs(x_d).max()


def test_contact_too_stiff_to_be_found_is_searched_for_from_softer_on(monkeypatch):
    """Ever stiffer, each search from what the last one found but with the history of the first, the last as stiff."""
    system, asked = build(CZM1).system, []

    def search(tried, trial, control, opening, change, newton, phase):
        asked.append((tried.interface.law.penalty / system.interface.law.penalty, trial.load, trial.k_q is history))
        if len(asked) in (1, 3):
            return None
        return SimpleNamespace(state=replace(trial, load=10.0 * len(asked), k_q=None))

    monkeypatch.setattr(iga.path, "equilibrium", search)
    start = system.start()
    history = start.k_q
    found = iga.path._touching(system, start, 0.1, 0.1, lambda name: None)
    parts, loads_before, same = zip(*asked, strict=True)
    assert parts == pytest.approx((1.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0)) and all(same)
    assert loads_before == (0.0, 0.0, 20.0, 20.0, 40.0, 50.0, 60.0, 70.0) and found.state.load == 80.0
