"""The bond at points: its tangent, its histories, and the energies that they take."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.verify.theory.arms.quotients import derivative
from tests.verify.theory.arms.specimens import ARM
from verify.theory.arms.interface import MOST_HELD, History, Interface, give_of
from verify.theory.law import Softened
from verify.theory.mixed_law import MixedBond

MIXED = MixedBond("bilinear", (60.0, 90.0), (0.3, 0.9), (1e5, 2e5), 1.5e5, "bk", 2.1)
RUBBED = replace(MIXED, friction=0.4)
LAWS = {
    "opening": Softened(6.0, 0.2, 10.0, 1e3),
    "opening without contact": Softened(6.0, 0.2, 10.0, 1e3, contact=False),
    "bk": MIXED,
    "power": replace(MIXED, criterion="power", exponent=1.4),
    "trapezoidal": replace(MIXED, law="trapezoidal", plateau=0.3),
    "trilinear": replace(MIXED, law="trilinear"),
    "softening": replace(MIXED, law="exponential-softening"),
    "exponential": replace(MIXED, law="exponential"),
    "friction": RUBBED,
    "friction on an area": replace(RUBBED, rubs="area"),
}


def face(name: str, points: int = 1, irreversible: bool = True) -> Interface:
    bond = replace(LAWS[name], irreversible=irreversible)
    return Interface(
        bond, np.ones((1, points), dtype=bool), np.zeros(2 if bond.slides else 1), np.arange(points)[None] + 0.0
    )


def along(one: Interface, path: np.ndarray) -> tuple[History, np.ndarray]:
    """Histories and last jumps after a path (t, J) at every point, straight between its corners."""
    history, before = one.intact, np.zeros((1, one.bonded.shape[1], one.components))
    for corner in path:
        start = before
        for part in np.linspace(0.0, 1.0, 41)[1:]:
            jump = (1.0 - part) * start + part * corner
            history, before = one.advanced(jump, before, history), jump
    return history, before


#: From (g, s) of the history in jumps at onset, where the tangent is taken.
STATES = {
    "elastic": ((0.3, 0.2), (0.4, 0.3)),
    "growing": ((2.0, 1.5), (3.0, 2.0)),
    "unloading": ((3.0, 2.0), (1.0, -0.5)),
    "broken": ((300.0, 200.0), (30.0, 10.0)),
    "pressed, growing": ((-0.2, 2.5), (-0.3, 3.5)),
    "pressed, sliding back": ((-0.2, 4.0), (-0.3, 1.0)),
    "pressed, stuck": ((-0.2, 4.0), (-0.3, 3.95)),
    "broken, rubbing": ((-0.2, 300.0), (-0.3, 310.0)),
}


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("name", LAWS)
def test_the_tangent_is_that_of_difference_quotients(name, state):
    one = face(name)
    scale = one.bond.scale
    path, at = (np.array(part)[: len(scale)] * scale for part in STATES[state])
    history, _ = along(one, path[None])
    jump = np.broadcast_to(at, (1, 1, len(scale)))
    found = one.respond(jump, history)
    quotient = derivative(lambda j: one.respond(j, history).traction, jump, 1e-5 * float(scale.min()))
    assert found.tangent == pytest.approx(quotient, rel=2e-4, abs=2e-4 * np.abs(quotient).max() + 1e-9)


@pytest.mark.parametrize("name", ["friction", "friction on an area"])
def test_a_broken_bond_that_is_open_has_no_stiffness(name):
    """Where it has not moved since the last step, too: there is nothing that its faces could stick to."""
    one = face(name)
    history, jump = along(one, np.array([[1.0, 1.0]]))
    assert history.d.item() == 1.0
    assert not one.respond(jump, history).tangent.any() and not one.respond(jump, history).traction.any()


def test_a_point_that_slid_last_slides_on_unless_it_is_frozen():
    """The tangent at the state itself, by which the next step is guessed, and by which the path turns."""
    one = face("friction")
    history, jump = along(one, np.array([[-1e-3, 1.0]]))
    on, back = (one.respond(jump, history, frozen).tangent[0, 0] for frozen in (False, True))
    mu = one.bond.friction * MIXED.penalty
    assert on == pytest.approx(np.array([[MIXED.penalty, 0.0], [-mu, 0.0]]), abs=1e-6)
    assert back == pytest.approx(np.diag([MIXED.penalty, MIXED.stiffness[1]]), rel=1e-12)


@pytest.mark.parametrize("name", ["opening", "bk", "exponential"])
def test_a_point_that_fails_has_taken_its_toughness(name):
    """At any mode ratio, by the sum over steps; an unloading in between takes nothing."""
    one = face(name)
    for mode in ((1.0, 0.0), (1.0, 0.7), (0.0, 1.0)):
        if not one.bond.slides and mode[1]:
            continue
        way = np.array(mode)[: one.components] * one.bond.scale
        far = 6000.0 if name == "exponential" else 400.0
        path = np.array([2.0, 0.5, 5.0, 1.0, 20.0, far])[:, None] * way
        history, _ = along(one, path)
        B = float(one.bond.mode_ratio(*way)) if one.bond.slides else 0.0
        assert history.released.item() == pytest.approx(one.bond.critical(B), rel=0.02)


def test_friction_takes_limit_times_slip_of_a_broken_bond():
    one = face("friction")
    g, forth = -1e-3, 0.5
    history, jump = along(one, np.array([[g, 1.0]]))
    after, _ = along(one, np.array([[g, 1.0], [g, 1.0 - forth]]))
    limit = one.bond.friction * MIXED.penalty * -g
    stuck = 2.0 * limit / MIXED.stiffness[1]  # the way from one limit to the other
    assert after.rubbed - history.rubbed == pytest.approx(limit * (forth - stuck), rel=1e-6)
    assert one.respond(jump, history).traction[0, 0] == pytest.approx([MIXED.penalty * g, limit])


def test_points_that_never_were_bonded_are_broken_and_take_nothing():
    one = replace(face("bk"), bonded=np.zeros((1, 1), dtype=bool))
    for jump, traction in (((0.1, 0.2), (0.0, 0.0)), ((-0.1, 0.2), (-0.1 * MIXED.penalty, 0.0))):
        history, at = along(one, np.array([jump]))
        assert one.respond(at, history).traction[0, 0] == pytest.approx(traction)
        assert history.released.item() == 0.0 and history.progress.item() == 0.0


@pytest.mark.parametrize("name", ["opening", "bk", "power", "trapezoidal"])
def test_progress_goes_from_onset_to_failure_and_never_back(name):
    one = face(name)
    way = one.bond.scale * np.array([1.0, 0.8])[: one.components]
    reached = [one.growth(t * way[None, None], one.intact)[0].item() for t in np.linspace(0.0, 500.0, 2001)]
    assert reached[0] == 0.0 and reached[-1] == 1.0 and np.all(np.diff(reached) >= 0.0)
    history, _ = along(one, np.array([3.0, 1.0])[:, None] * way)
    now, slope = one.growth(np.array([[way]]).reshape(1, 1, -1), history)
    assert now == history.progress and 0.0 < now.item() < 1.0 and not slope.any()
    jump = (4.0 * way)[None, None]
    by = derivative(lambda j: one.growth(j, history)[0], jump, 1e-5 * float(one.bond.scale.min()))
    assert one.growth(jump, history)[1] == pytest.approx(by, rel=1e-3)


def test_a_reversible_bond_forgets():
    one = face("opening", irreversible=False)
    way = np.array([[5.0]]) * one.bond.scale
    history, _ = along(one, np.concatenate((way, 0.2 * way)))
    assert history.d.item() == pytest.approx(0.0, abs=1e-12) and history.released.item() == pytest.approx(0.0)


@pytest.mark.parametrize("name", ["bk", "power", "trapezoidal", "trilinear", "softening"])
@pytest.mark.parametrize("thickness", [1.5, 6.0])
def test_bond_and_arms_have_one_state_at_every_jump_of_the_faces(name, thickness):
    """However steeply the traction falls: 1 + c dt/djump has no eigenvalue below 1 - `MOST_HELD` in the pure modes, and
    none near 0 between them."""
    one = face(name)
    give = give_of((replace(ARM, thickness=thickness),) * 2, one.bond)[:, None]
    least = []
    for B in np.linspace(0.0, 1.0, 11):
        onset, *_, end = one.bond.corners(B)
        for size in onset + np.linspace(1e-3, 0.999, 100) * (end - onset):
            jump = size * np.sqrt(np.array([1.0 - B, B]) / one.bond.slopes)
            tangent = one.respond(jump[None, None], one.intact).tangent[0, 0]
            least.append(np.linalg.eigvals(np.eye(2) + give * tangent).real.min())
    assert min(least[:100] + least[-100:]) > 1.0 - MOST_HELD - 1e-3 and min(least) > 0.1
    assert thickness < 5.0 or min(least) < 0.5, "the limit is reached"
