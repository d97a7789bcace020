"""The tangent of the path against what the path does next, and which way is forward."""

from dataclasses import replace

import numpy as np
import pytest
from specimens import PAPER

from iga.bases.names import BASES
from iga.dcb import build
from iga.path.control import Prescribed, gap_control, opening_control
from iga.path.follow import follow
from iga.path.newton import equilibrium
from iga.path.point import Point
from iga.path.solver import Solver
from iga.path.tangent import _untried, on_envelope, tangent
from iga.system.system import respond

#: The path is followed to a third of the opening that the mesh is made for: elements are so long that it snaps back.
SNAPPING = replace(PAPER, strength=6.0, opening=(3.0,))


def points_of(system, programme, steps=60):
    return [p for p in follow(Solver(system), programme, steps) if isinstance(p, Point)]


SNAPPING_ONES = [
    replace(SNAPPING, basis="nurbs"),
    replace(SNAPPING, basis="lagrange"),
    replace(SNAPPING, basis="lagrange", kinematics="linear"),
    replace(SNAPPING, basis="tspline", strength=10.0, dofs=200),
]


@pytest.fixture(scope="module", params=SNAPPING_ONES, ids=lambda problem: f"{problem.basis}-{problem.kinematics}")
def snapping(request):
    """A system whose path snaps back, and its points."""
    system = build(request.param).system
    return system, points_of(system, (1.0,))


def beside(system, point, control, change):
    """The converged state so near to a point that the path between them is straight, or None."""
    path, (value, a_d, a_load) = point.tangent, control(point.state, point.response)
    away = change / (a_d @ path.du_d + a_load * path.d_load)
    trial = replace(
        point.state,
        u_d=point.state.u_d + away * path.du_d,
        load=point.state.load + away * path.d_load,
    )
    return equilibrium(Solver(system), trial, Prescribed(control, value + change, change))


def fastest(point):
    """The point of the interface that opens fastest of those whose damage grows."""
    return int(np.argmax(np.where(point.tangent.growing_q, point.tangent.rate_q, -np.inf)))


def growing(points):
    return [p for p in points if np.any(p.tangent.growing_q)]


def test_the_tangent_is_the_difference_quotient_of_two_converged_points(snapping):
    """All points with growing damage, snap-backs among them: direction, slope, and the rates of the gaps."""
    system, points = snapping
    # straight as a linear path is between two kinks, a longer step stands out better from what the balance leaves open
    step = (1e-4 if system.linear else 1e-6) * system.interface.law.g_u
    worst, tried = 0.0, 0
    for point in growing(points):
        path = point.tangent
        q = fastest(point)
        near = beside(system, point, gap_control(system, q), step)
        assert near is not None
        du_d, d_load = near.state.u_d - point.state.u_d, near.state.load - point.state.load
        scale = step / path.rate_q[q]
        unsure = 1e-7 * np.linalg.norm(point.state.u_d)  # what rounding leaves open of an arm that turns
        assert np.linalg.norm(du_d - scale * path.du_d) < 1e-3 * np.linalg.norm(du_d) + unsure
        assert d_load == pytest.approx(scale * path.d_load, rel=1e-3)
        assert d_load / float(system.load_d @ du_d) == pytest.approx(path.slope, rel=1e-3)
        rates = (near.response.contact.g_q - point.response.contact.g_q) / scale
        worst = max(worst, float(np.max(np.abs(rates - path.rate_q)) / np.max(np.abs(rates))))
        tried += 1
    print(f"{tried} tangents, rates of the gaps within {worst:.1e}")
    assert tried > 20 and worst < 1e-3


def test_on_a_snap_back_damage_grows_while_the_opening_falls(snapping):
    """Forward is where energy is dissipated, whatever the opening does there."""
    system, points = snapping
    back = [(a, b) for a, b in zip(points[:-1], points[1:], strict=True) if a.heading < 0.0 and b.heading < 0.0]
    assert back, "no snap-back"
    for start, end in back:
        path = start.tangent
        assert float(system.load_d @ path.du_d) < 0.0 and path.slope > 0.0 and path.d_load < 0.0
        assert np.any(path.growing_q) and np.all(path.rate_q[path.growing_q] > 0.0)
        assert end.opening < start.opening
        spent = [p.energies.dissipated for p in (start, end)]
        assert spent[1] > spent[0]


def test_points_whose_rates_disagree_go_down_their_secants():
    """Of all points on the envelope those soften that go on opening, and no others; what the path does next says so.

    So strong an interface on so few elements, six on the bond, that a part of the zone closes while another opens.
    """
    x, h = np.append(0.0, np.linspace(SNAPPING.precrack, SNAPPING.length, 7)), SNAPPING.arm_thickness
    arms = tuple(BASES["lagrange"].rectangle((3, 2), x, np.array([y, y + h])) for y in (0.0, -h))
    problem = replace(SNAPPING, strength=20.0, meshes=arms, interface_points=4, kinematics="linear")
    system = build(problem).system
    points, turned = growing(points_of(system, (1.0,))), 0
    for point in points:
        path, least = point.tangent, 1e-9 * np.max(np.abs(point.tangent.rate_q))
        soft_q = on_envelope(system, point.state, point.response)
        assert np.all(path.rate_q[path.growing_q] > 0.0) and np.all(path.rate_q[soft_q & ~path.growing_q] <= least)
        assert not np.any(path.growing_q & ~soft_q)
        if not np.array_equal(soft_q, path.growing_q):
            turned += 1
            q, step = fastest(point), 1e-6 * system.interface.law.g_u
            near = beside(system, point, gap_control(system, q), step)
            grown_q = near.response.k_q > point.state.k_q
            assert np.array_equal(grown_q & soft_q, path.growing_q)
            # a change of load of a millionth, known to the rounding of arms that turn
            assert near.state.load - point.state.load == pytest.approx(step / path.rate_q[q] * path.d_load, rel=1e-3)
    assert turned > 0, "nowhere anything to be sorted out"


def test_at_a_turning_point_the_way_back_is_the_difference_quotient():
    """Finite kinematics and contact."""
    system = build(replace(PAPER, dofs=400)).system
    top = points_of(system, (0.7,))[-1]
    back = tangent(Solver(system), top.state, respond(system, top.state, decide=False), -1.0, turning=True)
    turned = replace(top, tangent=back)
    near = beside(system, turned, opening_control(system), -1e-5)
    assert back.slope == pytest.approx((near.state.load - top.state.load) / -1e-5, rel=1e-4)
    assert np.array_equal(near.response.k_q, top.state.k_q), "damage grows on the way back"


@pytest.mark.parametrize("by", [-1.0, 1.0, 8.0])
def test_where_a_path_sets_out_again_rounding_of_the_history_does_not_matter(by):
    """A point that softens goes on along the envelope, though its gap is a last digit below its history."""
    system = build(replace(PAPER, dofs=400)).system
    top = next(p for p in points_of(system, (1.0,)) if np.sum(p.tangent.growing_q) >= 2)
    k_q = top.state.k_q * (1.0 + by * np.finfo(float).eps)
    state = replace(top.state, k_q=k_q)
    again = tangent(Solver(system), state, respond(system, state, decide=False), 1.0, turning=True)
    assert np.array_equal(again.growing_q, top.tangent.growing_q)
    assert again.slope == pytest.approx(top.tangent.slope, rel=1e-6)


def test_a_reversible_law_goes_back_on_its_own_curve():
    system = build(replace(PAPER, dofs=800, irreversible=False)).system
    stops = (0.3, 0.6, 0.8, 0.6, 0.3)
    points = points_of(system, stops, steps=40)
    there, back = ([p for p in points if p.opening == stop] for stop in (0.3, 0.6))
    assert points[-1].opening == 0.3 and all(len(pair) == 2 for pair in (there, back))
    assert back[0].slope < 0.0 or back[0].state.load > 0.9 * max(p.state.load for p in points), "still elastic"
    for out, again in (there, back):
        assert again.state.load == pytest.approx(out.state.load, rel=1e-9)
        assert again.heading == -1.0 and again.slope == pytest.approx(out.slope, rel=1e-6)


def test_where_all_changes_at_once_lead_round_one_is_made_that_has_not_been_tried():
    """Two points that soften: both grow, the second is to unload, and then to grow again; the first one has to."""
    both, first, second, none = (np.array(grows, dtype=bool) for grows in ([1, 1], [1, 0], [0, 1], [0, 0]))
    tried, soft, now_q, went = {both.tobytes(), first.tobytes()}, np.array([0, 1]), first, []
    assert np.array_equal(_untried(both, second, soft, tried), second), "as long as it is new what is asked is done"
    for _ in range(2):
        now_q = _untried(now_q, both, soft, tried)
        tried.add(now_q.tobytes())
        went.append(now_q.tolist())
    assert went == [none.tolist(), second.tolist()]
