"""Scenes in the terms of every solver, and what a solver without a mesh leaves blank."""

from __future__ import annotations

import sys
from dataclasses import MISSING, fields, replace
from types import SimpleNamespace

import numpy as np
import pytest

from iga.dcb import Problem as Dcb
from iga.elements.elasticity import orthotropic
from verify.checks.identities import run_checks
from verify.methods import dolfinx
from verify.methods.built_in import dolfinx as dolfinx_method
from verify.methods.method import Failure
from verify.methods.problems import SNAPSHOT_FRACTIONS
from verify.methods.solve import prepare, solve
from verify.scene.load import load_scene
from verify.scene.materials import axial_modulus, elastic_constants
from verify.scene.parse import parse_scene


@pytest.mark.parametrize("plane", ["stress", "strain"])
@pytest.mark.parametrize("overrides", [[], ["material={E1=120e3, E2=9e3, G12=5e3, nu12=0.3}"]])
def test_the_axial_modulus_is_that_of_a_layer_free_to_contract_across(plane, overrides):
    """Second route: one over the compliance of the plane problem that the elements have."""
    material = load_scene("dcb-czm1", overrides).material
    c = elastic_constants(material)
    D = orthotropic(c["E1"], c["E2"], c["G12"], c["nu12"], plane)
    assert axial_modulus(material, plane) == pytest.approx(1.0 / np.linalg.inv(D)[0, 0], rel=1e-12)


@pytest.mark.parametrize("method", ["nurbs", "beam", "lefm"])
def test_a_result_tells_how_large_its_system_was(method):
    """Theories have no system of the plane, and fracture mechanics none at all."""
    scene = load_scene("dcb-czm1", ["discretization.dofs=280", "discretization.steps=5", "load.opening=0.5"])
    result = solve(scene, method)
    assert result.complete and result.seconds["total"] >= 0.0
    assert [size > 0 for size in (result.dofs, result.elements)] == [method != "lefm"] * 2
    assert (result.condition > 1.0) == (method == "nurbs")
    if method != "nurbs":
        assert result.nonzeros == 0
        return
    assert abs(result.dofs - 280) <= 6 and 0 < result.elements < result.dofs
    assert len(result.snapshots) == len(SNAPSHOT_FRACTIONS)
    assert [round(one.opening, 9) for one in result.snapshots] == [0.05, 0.1, 0.25, 0.5]


def opened(*overrides: str) -> np.ndarray:
    return solve(load_scene("dcb-czm1", ["load.opening=0.2", *overrides]), "nurbs").opening


def test_the_path_chooses_its_steps_where_the_mesh_resolves_the_zone():
    """Elsewhere there are as many as are asked for by default."""
    strong = ("interface.strength=20.0", "discretization.dofs=280", "load.opening=1.0")
    coarse = opened(*strong, "discretization.steps=auto")
    assert np.array_equal(coarse, opened(*strong, "discretization.steps=150"))
    fine = opened("discretization.dofs=2000", "discretization.interface_points=4", "discretization.steps=auto")
    assert len(fine) < 75 < len(coarse) and (fine[-1], coarse[-1]) == (0.2, 1.0)


@pytest.mark.parametrize("name", ["dcb-czm1", "peel-60"])
def test_fracture_mechanics_goes_beyond_its_factors_by_the_elastica(name):
    """Opened by more than the length, the arms are no longer what the factors for large displacements were made for."""
    scene = load_scene(name)
    far = 1.2 * scene.specimen.extent
    result = solve(load_scene(name, [f"load.opening={far}", "discretization.steps=20"]), "lefm")
    assert result.opening[-1] <= far and np.all(np.isfinite(result.load)) and result.load.max() > 0.0


def test_an_error_of_dolfinx_comes_out_with_whose_it_is(monkeypatch):
    """Of its calls alone; what the solver itself raises is as it was, and so is all of a DOLFINx that is supported."""
    monkeypatch.setitem(sys.modules, "dolfinx", None)
    assert dolfinx.another_dolfinx() == ""

    def broken(problem, **how) -> None:
        raise broken.error

    prepared = prepare(load_scene("dcb-czm1", ["dolfinx.elements=20"]), "dolfinx")
    monkeypatch.setitem(sys.modules, "fem_reference.solve", SimpleNamespace(solve_debonding=broken))
    for version, kinds in (("0.8.0", (TypeError, AttributeError, ImportError)), ("0.10.0", ())):
        monkeypatch.setitem(sys.modules, "dolfinx", SimpleNamespace(__version__=version))
        for kind in (TypeError, AttributeError, ImportError, ValueError):
            broken.error = kind("no luck")
            with pytest.raises(Failure if kind in kinds else kind, match="no luck") as caught:
                dolfinx_method.solve(prepared, lambda row: None, None)
            if kind in kinds:
                whose = "DOLFINx 0.8.0, or for it: debond takes 0.9 to 0.11, see debond doctor"
                assert caught.value.whose == whose and caught.value.__cause__ is broken.error


BARE = {
    "dcb": {"length": 14.0, "arm_thickness": 0.2, "precrack": 4.0},
    "peel": {
        "strip_length": 150.0, "strip_thickness": 2.0, "substrate_length": 120.0, "substrate_thickness": 10.0,
        "bond_length": 60.0,
    },
}  # fmt: skip


@pytest.mark.parametrize("kind", BARE)
def test_what_is_not_told_is_the_same_for_a_solver_and_for_a_scene(kind):
    """But for the snapshots, for theories that are linear by themselves, and for meshes and steps of both solvers: a
    scene leaves them to its process zone, of which the solvers know nothing."""
    stiff = {"young": 120e3, "poisson": 0.2}
    bodies = {"material": stiff} if kind == "dcb" else {"strip": stiff, "substrate": stiff}
    raw = {"specimen": {"kind": kind, **BARE[kind]}, **bodies, "interface": {"strength": 4.0, "toughness": 0.1}}
    mesh = {"discretization": {"dofs": 1956}, "dolfinx": {"elements": 112}}
    scene = parse_scene({**raw, "load": {"opening": 1.0}, **mesh})
    problems = [prepare(scene, "nurbs").problem[1]]
    problems += [prepare(scene, name).problem for name in ("dolfinx", "beam", *["lefm"] * (kind == "dcb"))]
    for problem in problems:
        known = {field.name: field.default for field in fields(problem) if field.default is not MISSING}
        for name in {"snapshot_openings", "opening", "substrate", "clamps", "on_base", "loaded_at"} | (
            {"kinematics"} if "points" in known else set()
        ):
            known.pop(name, None)
        if "steps" in known:
            assert known.pop("steps") == 150 and problem.steps is None
        if "slave" in known:  # of `iga`, where these follow from others
            told = {"length": 14.0, "arm_thickness": 0.2, "precrack": 4.0, "E1": 120e3, "nu12": 0.2, "opening": 1.0}
            untold = Dcb(**told, strength=4.0, toughness=0.1).law
            assert type(untold) is type(problem.law) and untold.shape == problem.law.shape
            numbers = {name: value for name, value in vars(untold).items() if name not in ("shape", "table")}
            assert {name: getattr(problem.law, name) for name in numbers} == pytest.approx(numbers)
            plain = {name: known.pop(name) for name in ("E2", "G12") if name in known}
            assert not plain or replace(problem, **plain).elasticity == pytest.approx(problem.elasticity)
        assert {name: getattr(problem, name) for name in known} == known, type(problem)


@pytest.mark.parametrize("order", [1, 3])
def test_the_stiffest_contact_stops_no_beam(order):
    """A contact ten million times as stiff as the bond left no equilibrium; it is that of the arms across."""
    words = [f"beam.order={order}", "load.opening=0.8", "effects.kinematics=linear"]
    stiff, usual = (solve(load_scene("dcb-czm1", [*words, f"interface.penalty={p}"]), "beam") for p in ("1e10", "1e5"))
    assert stiff.complete and stiff.load.max() == pytest.approx(usual.load.max(), rel=1e-3)
    assert run_checks(load_scene("dcb-czm1", words), stiff, "beam").fault == ""
