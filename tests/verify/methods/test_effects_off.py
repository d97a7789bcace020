"""An effect that is off costs nothing: its code is not reached, or takes no time that could be told.

What "absent" means is written out here for each of them: the same solver with the branch taken out of the law, of the
decision on contact, or of the geometry of the interface.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager, nullcontext
from dataclasses import asdict, dataclass, replace
from statistics import median
from time import process_time

import numpy as np
import pytest

from iga.dcb import Problem, build
from iga.interface import interface as interface_of
from iga.interface.contact import Contact
from iga.interface.interface import SearchedInterface, SettledInterface
from iga.laws.opening import SofteningLaw
from iga.path.condensation import condensed
from iga.path.follow import follow
from iga.path.point import End, Point
from iga.path.solver import Solver
from iga.run import Solution, run
from iga.specimen import bond as bond_of
from iga.specimen.specimen import Specimen
from iga.system import system as system_of
from iga.system.bulk import FiniteBulk, LinearBulk
from iga.system.system import untimed
from verify.methods.solve import prepare
from verify.scene.load import load_scene

#: How much longer a step with the effect off may take than one without its code, and runs to tell.
WITHIN, REPEATS = 0.03, 8


#: Damage has begun; a second of work for finite kinematics, and what is long enough to be timed.
SMALL = ("discretization.dofs=300", "discretization.steps=12", "load.opening=0.6")
TIMED = ("discretization.dofs=600", "discretization.steps=30", "load.opening=0.8")


def problem(*overrides: str) -> Problem:
    given = (*SMALL, *overrides)
    return prepare(load_scene("dcb-czm1", given), "nurbs").problem[1]


def built(problem: Problem, law: SofteningLaw | None = None) -> Specimen:
    """The specimen, with another law where one is given."""
    specimen = build(problem)
    if law is None:
        return specimen
    system = specimen.system
    return replace(specimen, system=replace(system, interface=replace(system.interface, law=law)))


def solved(problem: Problem, law: SofteningLaw | None = None) -> Solution:
    return run(problem, built(problem, law), None, untimed)


def steps_of(problem: Problem, law: SofteningLaw | None = None) -> Iterator[Point | End]:
    """The path, step by step, as `iga.run.run` follows it."""
    system = built(problem, law).system
    small = condensed(system)
    return follow(Solver(system if small is None else small.system), problem.opening, problem.steps)


# --- what absent means


class WithoutContact(SofteningLaw):
    """The law with nothing of contact in it."""

    def traction(self, g, k, closed=None):
        k_new = np.maximum(k, g)
        secant = self.secant(k_new)
        softening = (g >= k_new) & (g > self.g_max) & (g < self.g_u)
        return secant * g, np.where(softening, -self.strength / (self.g_u - self.g_max), secant), k_new

    def energies(self, g, k):
        secant = self.secant(k)
        return 0.5 * secant * g**2, np.zeros_like(g), self.work(k) - 0.5 * secant * k**2


class WithoutHistory(SofteningLaw):
    """The law as a function of the gap alone."""

    def traction(self, g, k, closed=None):
        opened = np.maximum(g, 0.0)
        secant = self.secant(opened)
        softening = (g > self.g_max) & (g < self.g_u)
        slope = np.where(softening, -self.strength / (self.g_u - self.g_max), secant)
        closed = g < 0.0 if closed is None else closed
        return np.where(closed, self.penalty, secant) * g, np.where(closed, self.penalty, slope), opened

    def energies(self, g, k):
        closed, nothing = g < 0.0, np.zeros_like(g)
        stored = np.where(closed, 0.0, self.work(np.maximum(g, 0.0)))
        return stored, np.where(closed, 0.5 * self.penalty * g**2, 0.0), nothing


def gaps_in_proportion(interface: SettledInterface, u_d: np.ndarray, guess: object) -> Contact:
    """All that linear kinematics asks of the geometry."""
    return replace(interface.at_rest, g_q=interface.at_rest.g_q + interface.at_rest.rates(u_d))


def never(*_: object, **__: object) -> None:
    raise AssertionError("an effect that is off was asked for")


@dataclass(frozen=True)
class Off:
    """A problem with an effect off, the law that lacks it, and what is put in place of parts of the solver."""

    overrides: tuple[str, ...]
    law: type[SofteningLaw] | None
    instead: Mapping[tuple[object, str], object]

    @contextmanager
    def absent(self, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
        """The parts taken out, for the block."""
        with monkeypatch.context() as patch:
            for (module, name), part in self.instead.items():
                patch.setattr(module, name, part)
            yield

    def law_without(self, problem: Problem) -> SofteningLaw | None:
        return None if self.law is None else self.law(**asdict(problem.law))


#: A point's contact is never decided.
UNDECIDED = {(system_of, "_closed"): lambda system, touch, trial, scale: trial.closed_q}

OFF = {
    "contact": Off(("effects.contact=false",), WithoutContact, UNDECIDED),
    "irreversible": Off(("effects.irreversible=false",), WithoutHistory, {}),
    "kinematics": Off(
        ("effects.kinematics=linear",),
        None,
        {(SettledInterface, "contact"): gaps_in_proportion, (SettledInterface, "slopes"): never},
    ),
    "kinematics, one arm": Off(
        ("effects.kinematics=linear", "effects.symmetry=true"),
        None,
        {(SettledInterface, "contact"): gaps_in_proportion, (SettledInterface, "slopes"): never},
    ),
}


@pytest.mark.parametrize("name", OFF)
def test_without_its_code_the_numbers_are_the_same(name, monkeypatch):
    """Else times would compare two problems. One row after the other, to what Newton leaves."""
    off, one = OFF[name], problem(*OFF[name].overrides)
    ours = solved(one)
    with off.absent(monkeypatch):
        theirs = solved(one, off.law_without(one))
    assert ours.status == theirs.status == "complete" and len(ours.rows) == len(theirs.rows)
    for key in ("opening", "load", "dissipated_energy", "contact_energy"):
        a, b = (np.array([row[key] for row in one.rows]) for one in (ours, theirs))
        np.testing.assert_allclose(a, b, rtol=1e-6, atol=1e-9 * np.max(np.abs(a), initial=0.0) + 1e-15)


@pytest.mark.slow
@pytest.mark.parametrize("name", OFF)
def test_an_effect_that_is_off_costs_nothing(name, monkeypatch):
    """The median of the ratios of times of a step, each pair of steps one after the other, with either first in turn.

    A step takes milliseconds: what else the machine does falls upon both of a pair.
    """
    off, one = OFF[name], problem(*OFF[name].overrides, *TIMED)
    ratios = []
    for _ in range(REPEATS):
        both, count, last = (steps_of(one), steps_of(one, off.law_without(one))), 0, None
        while not isinstance(last, End):
            seconds, count = [0.0, 0.0], count + 1
            for side in (0, 1) if count % 2 else (1, 0):
                with off.absent(monkeypatch) if side else nullcontext():
                    start = process_time()
                    last = next(both[side])
                    seconds[side] = process_time() - start
            if not isinstance(last, End):
                ratios.append(seconds[0] / seconds[1])
    low, high = np.percentile(ratios, (25, 75))
    print(f"{name}: off over absent {median(ratios):.4f}, half of the ratios from {low:.3f} to {high:.3f}")
    assert median(ratios) <= 1.0 + WITHIN


def test_linear_kinematics_never_searches_nor_turns_a_normal(monkeypatch):
    """Pairs are found before anything moves; the steps themselves ask for no geometry and for no element."""
    one = problem("effects.kinematics=linear")
    specimen = build(one)
    searched = []
    found = interface_of.closest_points
    monkeypatch.setattr(interface_of, "closest_points", lambda *a: searched.append(1) or found(*a))
    for kind in (FiniteBulk, LinearBulk):
        monkeypatch.setattr(kind, "respond", never)
    counts = []
    for steps in (5, 40):
        searched.clear()
        assert run(replace(one, steps=steps), build(replace(one, steps=steps)), None, untimed).status == "complete"
        counts.append(len(searched))
    assert counts[0] == counts[1], "searches grow with the steps"
    assert isinstance(specimen.system.interface, SettledInterface)


def test_one_arm_has_no_other(monkeypatch):
    """Half the unknowns, no second surface, no search, ever; and both arms have nothing of a mirror."""
    one, both = problem("effects.symmetry=true"), problem()
    half, whole = build(one), build(both)
    assert len(half.bodies) == 1 and 2 * half.system.n_dof == whole.system.n_dof
    assert np.array_equal(half.system.interface.rest.dof_qd[:, ::2] // 2, half.system.interface.conn_qa)
    assert isinstance(whole.system.interface, SearchedInterface)
    for name in ("closest_points", "nearest_samples", "master_points"):
        monkeypatch.setattr(interface_of, name, never)
    assert solved(one).status == "complete"
    monkeypatch.undo()
    monkeypatch.setattr(bond_of, "paired", never)
    assert solved(replace(both, opening=(0.2,), snapshot_openings=(), steps=5)).status == "complete"
