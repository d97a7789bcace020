"""T-meshes that follow the process zone: what is carried over, what it costs, and that the curve does not notice."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from made_up_laws import energies
from specimens import PAPER

from iga.dcb import build, solve
from iga.delamination import adaptive as adaptivity
from iga.delamination.adaptive import Window, carried, first_window, followed, strip
from iga.interface.surface import surface
from iga.path.follow import follow
from iga.path.point import End, Point
from iga.path.point import Point as Converged
from iga.path.solver import Solver
from iga.specimen.grading import GRADING
from iga.specimen.specimen import Specimen
from iga.system.state import State
from iga.system.system import untimed

ADAPTIVE = replace(PAPER, basis="tspline", adaptive=True, opening=(1.2,), dofs=800, steps=40)


@dataclass(frozen=True)
class Change:
    """A change of mesh: the point before, the state in which equilibrium was sought, and the one that was found."""

    old: Specimen
    new: Specimen
    before: Converged
    sought: State
    found: State


def changes(problem) -> tuple[list[Change], list[Converged], End]:
    """All changes of mesh of a run, its points, and how it ended."""
    first, made, sought = first_window(problem), [], []
    specimen = build(problem)

    def renew(point):
        nonlocal specimen
        window = followed(problem, first.roots, specimen, point)
        if window is None:
            return None
        new = build(problem, window=window)
        state = carried(specimen, new, point, untimed)
        if state is None:
            return None
        made.append(Change(specimen, new, point, sought[-1], state))
        specimen = new
        return new.system, state

    search = adaptivity.equilibrium
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            adaptivity, "equilibrium", lambda s, trial, *rest: sought.append(trial) or search(s, trial, *rest)
        )
        *points, end = follow(Solver(specimen.system), problem.opening, problem.steps, renew=renew)
    return made, points, end


@pytest.fixture(scope="module", params=["linear", "finite"])
def adaptive(request):
    found = changes(replace(ADAPTIVE, kinematics=request.param))
    assert len(found[0]) >= 3 and found[2].status == "complete"
    return found


def places(specimen: Specimen) -> np.ndarray:
    return specimen.distance(specimen.system.interface.X_qi)


def active(specimen: Specimen, k_q: np.ndarray) -> np.ndarray:
    law = specimen.system.interface.law
    return (k_q > law.g_max) & (k_q < law.g_u)


def interface_elements(specimen: Specimen) -> np.ndarray:
    """Start and end (n_c, 2) along the specimen of the upper arm's elements at the interface."""
    mesh = specimen.meshes[0]
    P_AI = specimen.system.interface.P_AI
    return specimen.distance(surface(mesh, mesh.chains["bottom"], 0).bezier_points(P_AI)[:, [0, -1]])


def test_elements_in_which_damage_grows_stay_as_they_are(adaptive):
    for change in adaptive[0]:
        s = places(change.old)[active(change.old, change.before.state.k_q)]
        assert s.size > 4, "nothing is being damaged where the mesh changes"
        before, after = interface_elements(change.old), interface_elements(change.new)
        holds = np.any((before[:, :1] < s) & (s < before[:, 1:]), axis=1)
        assert holds.sum() > 2
        for element in before[holds]:
            assert np.abs(after - element).max(1).min() < 1e-12 * 14.0
    assert len(interface_elements(adaptive[0][-1].new)) < 120


def test_history_goes_with_its_points_and_nothing_is_dissipated_by_a_change(adaptive):
    for change in adaptive[0]:
        damaged = active(change.old, change.before.state.k_q)
        s_old, s_new = places(change.old), places(change.new)
        same = np.abs(s_new[:, None] - s_old[damaged]) < 1e-11
        assert np.all(same.sum(0) == 1), "a point that is being damaged is lost"
        assert np.array_equal(change.sought.k_q[np.argmax(same, axis=0)], change.before.state.k_q[damaged])
        law = change.new.system.interface.law
        spent = [
            float(specimen.system.interface.dA_q @ energies(law, 0.0 * k_q, k_q)[2])
            for specimen, k_q in ((change.old, change.before.state.k_q), (change.new, change.sought.k_q))
        ]
        assert spent[0] > 0.0 and spent[1] == pytest.approx(spent[0], rel=1e-12)


def test_a_change_leaves_opening_load_and_energy_where_they_were(adaptive):
    """The arms bend a little less where elements get longer, and that is all: a thousandth of the load."""
    for change in adaptive[0]:
        before, found = change.before, change.found
        assert float(change.new.system.load_d @ found.u_d) == pytest.approx(before.opening, rel=1e-9)
        sought = float(change.new.system.load_d @ change.sought.u_d)
        assert sought == pytest.approx(before.opening, rel=1e-6), "displacements are not carried over"
        assert found.load == pytest.approx(before.state.load, rel=2e-3)
        assert np.all(found.k_q >= change.sought.k_q)


def test_points_go_on_without_a_jump_and_the_ledger_is_kept(adaptive):
    made, points, _ = adaptive
    dissipated = points[-1].energies.dissipated
    ledger = [abs(p.external_work - p.energies.total) for p in points]
    steps = np.diff([p.opening for p in points])
    print(f"{len(made)} changes, ledger {max(ledger) / dissipated:.1e} of what is dissipated")
    assert max(ledger) < 5e-3 * dissipated
    assert np.abs(steps).max() < 2.5 * 1.2 / 40 + 0.1
    assert all(isinstance(p, Point) for p in points)


@pytest.mark.parametrize("dofs", [500, 1000])
def test_never_more_unknowns_than_asked_for(dofs):
    """On the way, wherever the zone is; and no mesh with half as many would have done."""
    problem = replace(ADAPTIVE, kinematics="linear", dofs=dofs, opening=(2.4,), steps=20)
    made, points, end = changes(problem)
    counts = [made[0].old.system.n_dof, *(change.new.system.n_dof for change in made)]
    print(f"unknowns {min(counts)} to {max(counts)}")
    assert end.status == "complete" and points[-1].opening == 2.4
    assert dofs / 2 < max(counts) <= dofs


@pytest.mark.parametrize("start", [4.0, 5.3, 9.0, 13.9])
def test_cells_are_bisections_fine_in_the_window_and_ever_longer_away_from_it(start):
    window = Window(start, start + 1.0, 8)
    body, finest = strip(ADAPTIVE, window), 10.0 / 8 / 2**4
    x, size = body.breaks_c, np.diff(body.breaks_c)
    assert x[0] == 0.0 and x[-1] == 14.0 and 4.0 in x
    on_bond = x[x >= 4.0]
    assert np.allclose((on_bond - 4.0) / finest, np.round((on_bond - 4.0) / finest), atol=1e-9)
    inside = (x[1:] > window.start) & (x[:-1] < window.end) & (x[:-1] >= 4.0)
    assert np.allclose(size[inside], finest)
    away = np.maximum(np.maximum(window.start - x[1:], x[:-1] - window.end), 0.0)
    assert np.all(size <= np.maximum(1.5 * finest, 0.7 * away) + 1e-9)
    assert size.max() > 8.0 * finest
    pressed = np.diff(strip(replace(ADAPTIVE, opening=(1.2, -0.01)), window).breaks_c)[0]
    assert pressed <= max(1.5 * finest, GRADING.pressed * 0.2) < size.max(), "short where the arms are pressed together"
    middle = 0.5 * (x[1:] + x[:-1])
    assert np.array_equal(body.halved_c, (middle > max(window.start, 4.0)) & (middle < window.end))


def column(solution, name):
    return np.array([row[name] for row in solution.rows])


def test_the_curve_is_that_of_a_fine_mesh():
    """Elements at the interface are no longer than those of the fine one; unknowns are less than half as many."""
    problem = replace(ADAPTIVE, kinematics="linear", dofs=1000, opening=(0.9,))
    fine = replace(problem, adaptive=False, dofs=2000)
    few, many = solve(problem), solve(fine)
    assert few.status == many.status == "complete" and few.dofs < 0.5 * many.dofs
    opening = np.linspace(0.0, 0.9, 400)
    load, exact = (np.interp(opening, column(s, "opening"), column(s, "load")) for s in (few, many))
    error = np.linalg.norm(load - exact) / np.linalg.norm(exact)
    print(f"{few.dofs} unknowns against {many.dofs}: {error:.1e}")
    assert error < 2e-3
    assert few.rows[-1]["dissipated_energy"] == pytest.approx(many.rows[-1]["dissipated_energy"], rel=5e-3)


def test_a_programme_may_unload_close_and_open_again():
    problem = replace(ADAPTIVE, kinematics="linear", dofs=600, opening=(0.9, 0.0, 0.9, 1.2), steps=60)
    there, back = solve(replace(problem, opening=(0.9, 1.2), steps=20)), solve(problem)
    assert back.status == "complete"
    opening, load = column(back, "opening"), column(back, "load")
    (top, again), bottom = np.flatnonzero(opening == 0.9), np.flatnonzero(opening == 0.0)[-1]
    assert abs(load[bottom]) < 1e-8 * load.max() and load[again] == pytest.approx(load[top], rel=1e-6)
    assert back.rows[bottom]["dissipated_energy"] == pytest.approx(back.rows[top]["dissipated_energy"], rel=1e-9)
    assert load[-1] == pytest.approx(there.rows[-1]["load"], rel=2e-3)
    gap = column(back, "external_work") - column(back, "stored_energy") - column(back, "dissipated_energy")
    assert np.abs(gap).max() < 5e-3 * back.rows[-1]["dissipated_energy"]


def at_home(kinematics):
    return replace(ADAPTIVE, kinematics=kinematics, dofs=600, steps=20, opening=(0.8,))


def test_it_follows_wherever_the_specimen_lies():
    plain = solve(at_home("finite"))
    other = solve(replace(at_home("finite"), mirror=True, angle=-75.0, shift=(3.0, -2.0)))
    assert other.status == "complete" and len(plain.rows) == len(other.rows)
    for name in ("opening", "load", "dissipated_energy", "crack_length"):
        assert np.allclose(column(other, name), column(plain, name), rtol=1e-6, atol=1e-9), name


def test_one_arm_follows_as_both_do():
    """Linear kinematics: the same discrete problem with half of the unknowns."""
    problem = at_home("linear")
    whole, half = solve(problem), solve(replace(problem, symmetry=True))
    assert half.status == "complete" and 2 * half.dofs == whole.dofs
    for name in ("opening", "load", "dissipated_energy"):
        assert np.allclose(column(half, name), column(whole, name), rtol=1e-6, atol=1e-9), name


def test_too_few_unknowns_are_refused():
    with pytest.raises(ValueError, match="needs at least [0-9]+ unknowns, got 200"):
        solve(replace(ADAPTIVE, dofs=200))


def test_a_change_that_would_lose_a_damaged_point_is_not_made(adaptive):
    """A window ahead of the zone, whose cells there are long again."""
    change = adaptive[0][1]
    roots = first_window(ADAPTIVE).roots
    ahead = build(
        replace(ADAPTIVE, kinematics="linear" if change.old.system.linear else "finite"),
        window=Window(12.0, 13.0, roots),
    )
    assert carried(change.old, ahead, change.before, untimed) is None
