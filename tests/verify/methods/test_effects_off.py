"""An effect that is off costs nothing: its code is not reached."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from iga.dcb import Problem, build
from iga.interface import interface as interface_of
from iga.interface.interface import SearchedInterface, SettledInterface
from iga.run import Solution, run
from iga.specimen import bond as bond_of
from iga.system.bulk import FiniteBulk, LinearBulk
from iga.system.system import untimed
from verify.methods.solve import prepare
from verify.scene.load import load_scene

#: Damage has begun.
SMALL = ("discretization.dofs=300", "discretization.steps=12", "load.opening=0.6")


def problem(*overrides: str) -> Problem:
    given = (*SMALL, *overrides)
    return prepare(load_scene("dcb-czm1", given), "nurbs").problem[1]


def solved(problem: Problem) -> Solution:
    return run(problem, build(problem), None, untimed)


def never(*_: object, **__: object) -> None:
    raise AssertionError("an effect that is off was asked for")


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
