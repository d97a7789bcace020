"""Sequences of meshes among the runs: which runs belong to one, and what is said of their limit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from verify.result import Result
from verify.scene.load import load_scene
from verify.studies.mesh_sequences import QUANTITIES, sequences
from verify.verdict import Run, SceneReport

SCENE = load_scene("dcb-czm1")


def run(elements: int, method: str = "nurbs", off: float = 0.0, scene=None, **about) -> Run:
    """A run whose peak is 2 (1 + off); it dissipates 3 (1 + off) of a work of 5 (1 + off)."""
    d = np.linspace(0.0, 2.0, 41)
    whole = 1.0 + off
    steps = {
        "opening": d, "load": 2.0 * whole * np.sin(0.25 * np.pi * d), "dissipated_energy": 1.5 * whole * d,
        "external_work": 2.5 * whole * d,
    }  # fmt: skip
    return Run(f"{method} {elements}", method, Result(method, steps, elements=elements, **about), scene=scene)


def found(*runs: Run):
    return {(one.method, one.quantity): one for one in sequences(SceneReport(SCENE, runs, ()))}


def test_three_meshes_tell_the_limit_of_every_quantity():
    """Errors of (10 / n)^2: the limit of each is known, and so is how far every mesh is from the next."""
    runs = [run(n, off=(10.0 / n) ** 2) for n in (200, 50, 100)]
    told = found(*runs)
    assert set(told) == {("nurbs", name) for name in QUANTITIES}
    for (_, quantity), limit in zip(told, (2.0, 3.0, 5.0), strict=True):
        one = told["nurbs", quantity]
        assert [r.result.elements for r in one.runs] == [200, 100, 50], "the finest first"
        assert one.value == pytest.approx([limit * (1 + (10.0 / n) ** 2) for n in (200, 100, 50)])
        assert one.found.asymptotic and one.found.order == pytest.approx(2.0)
        assert one.found.limit == pytest.approx(limit)
        fine, middle, none = one.steps
        assert fine == pytest.approx((1 + 0.0025) / (1 + 0.01) - 1) and none is None
        assert middle == pytest.approx((1 + 0.01) / (1 + 0.04) - 1)


@pytest.mark.parametrize(
    "third",
    [
        run(50, status="stopped: here"),
        run(50, scene=load_scene("dcb-czm1", ["discretization.degree=2"])),
        run(50, scene=load_scene("dcb-czm1", ["discretization.adaptive=true"])),
        run(100),
        run(0),
        run(50, "tspline"),
        Run("none", "nurbs", None, "not run"),
    ],
    ids=["stopped", "another-degree", "moving", "the-same-mesh", "no-mesh", "another-method", "never-run"],
)
def test_what_is_no_third_mesh_of_the_same_kind_makes_no_sequence(third):
    two = [run(n, scene=SCENE) for n in (200, 100)]
    assert found(*two, third) == {}
    assert len(found(*two, third, run(50, scene=SCENE), run(25, scene=SCENE))) == len(QUANTITIES)


def test_what_a_code_does_not_tell_is_not_followed():
    runs = [run(n) for n in (50, 100, 200)]
    few = {key: runs[0].result.steps[key] for key in ("opening", "load")}
    bare = replace(runs[0], result=replace(runs[0].result, steps=few))
    unknown = {**runs[0].result.steps, "external_work": np.full(41, np.nan)}
    assert [name for _, name in found(bare, *runs[1:])] == ["peak load"]
    blind = replace(runs[0], result=replace(runs[0].result, steps=unknown))
    assert [name for _, name in found(blind, *runs[1:])] == ["peak load", "dissipated energy at the end"]


def test_degrees_of_dolfinx_are_its_own():
    scenes = [load_scene("dcb-czm1", [f"dolfinx.degree={p}"]) for p in (2, 2, 2, 3)]
    runs = [run(n, "dolfinx", scene=s) for n, s in zip((50, 100, 200, 400), scenes, strict=True)]
    assert {len(one.runs) for one in found(*runs).values()} == {3}
