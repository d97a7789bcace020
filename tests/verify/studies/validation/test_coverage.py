"""The interval of `debond validate` covers an error of the model that is known, as often as it says.

The inputs of every trial are drawn from the uncertainties that the scene states, the data are a run with them and with
errors of load cell and gauge, and the statement knows the nominal inputs alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np
import pytest

from verify.curves.curve import Curve
from verify.curves.of_run import cubics
from verify.methods.solve import solve
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.scene.stated.uncertainty import number_at, scaled
from verify.studies.validation.plan import planned
from verify.studies.validation.quantities import quantities
from verify.studies.validation.statement import Curves, Known, statement

TRIALS = 200
STATED = {
    "material.young": 0.03,
    "specimen.arm_thickness": 0.01,
    "specimen.precrack": 0.01,
    "interface.toughness": 0.05,
}
OF_DATA = {"data.load": 0.005, "data.opening": 0.005}
KNOWN = Known(STATED, OF_DATA)

#: What is solved fast: a sharp crack, and cohesive arms on a coarse mesh. The last number is an opening beside the
#: peak, whose place depends on the same inputs and on the gauge as its load.
SHARP = ("lefm", ("load.opening=3.0",), 0.44)
COHESIVE = ("nurbs", ("load.opening=1.3", "discretization.dofs=700", "discretization.steps=auto"), 0.62)


def scene_of(overrides: tuple[str, ...], factors: Mapping[str, float] | None = None) -> Scene:
    nominal = load_scene("dcb-czm1-linear", overrides)
    moved = [f"{key}={scaled(number_at(nominal, key), factor)}" for key, factor in (factors or {}).items()]
    return load_scene("dcb-czm1-linear", [*overrides, *moved])


def curve_of(method: str, scene: Scene) -> Curve:
    return cubics(solve(scene, method))


@cache
def simulated(method: str, overrides: tuple[str, ...]) -> Curves:
    """The nominal scene, and every input smaller and larger, by the runs that the command plans."""
    stated = [f"uncertainty.{key}={value}" for key, value in STATED.items()]
    scene = load_scene("dcb-czm1-linear", [*overrides, *stated, "uncertainty.introduction=false"])
    plan = planned("dcb-czm1-linear", scene, method, overrides)
    inputs = {key: (step, *(curve_of(method, j.solved) for j in pair)) for key, (step, *pair) in plan.inputs.items()}
    return Curves(curve_of(method, plan.base.solved), inputs)


@cache
def trials(method: str, overrides: tuple[str, ...]) -> tuple[tuple[Curve, tuple[float, float]], ...]:
    """Curves with true inputs, and what load cell and gauge make of their loads and openings."""
    rng, found = np.random.default_rng(20), []
    for _ in range(TRIALS):
        factors = {key: 1.0 + u * rng.standard_normal() for key, u in STATED.items()}
        errors = (
            1.0 + OF_DATA["data.load"] * rng.standard_normal(),
            1.0 + OF_DATA["data.opening"] * rng.standard_normal(),
        )
        found.append((curve_of(method, scene_of(overrides, factors)), errors))
    return tuple(found)


def covered(case: tuple[str, tuple[str, ...], float], planted: float, known: Known) -> dict[str, float]:
    """Part of the trials whose interval covers the error of the model, by quantity.

    ``planted``: by how much the loads of the model are too large.
    """
    method, overrides, at = case
    curves, hits = simulated(method, overrides), {}
    for (d, P), (of_load, of_opening) in trials(method, overrides):
        nature = (d, np.asarray(P) / (1.0 + planted))
        data = (of_opening * np.asarray(d), of_load * nature[1])
        for one in quantities(curves.scene, data, [at])[0]:
            low, high = statement(one, curves, data, known).interval
            error = one.of((d, P)) - one.of(nature)
            hits.setdefault(one.name, []).append(low <= error <= high)
    assert all(len(hit) == TRIALS for hit in hits.values())
    return {name: float(np.mean(hit)) for name, hit in hits.items()}


@pytest.mark.parametrize("planted", [0.0, 0.15])
def test_it_covers_the_error_of_the_model(planted: float) -> None:
    found = covered(SHARP, planted, KNOWN)
    assert set(found) == {"peak load", "initial stiffness", "propagation load", "load at 0.44"}
    assert all(0.9 <= part <= 0.99 for part in found.values()), found


def test_without_the_inputs_it_would_cover_far_too_little() -> None:
    """The test above can fail: most of the interval is theirs."""
    found = covered(SHARP, 0.0, Known(dict.fromkeys(STATED, 0.0), OF_DATA))
    assert all(part < 0.5 for part in found.values()), found


def test_a_kink_under_the_scatter_is_said() -> None:
    """Beside the peak of a sharp crack, whose place moves with every input, the load is not linear in them."""
    method, overrides, _ = SHARP
    curves = simulated(method, overrides)
    top = float(curves.scene[0][np.argmax(curves.scene[1])])
    said = [statement(one, curves, curves.scene, KNOWN) for one in quantities(curves.scene, curves.scene, [top])[0]]
    bent = {one.quantity: one.remarks for one in said}
    assert any("not linear in specimen.precrack" in remark for remark in bent.pop(f"load at {top:g}"))
    assert not any(bent.values())


@pytest.mark.slow
@pytest.mark.parametrize("planted", [0.0, 0.15])
def test_it_covers_beside_a_peak_that_moves_with_the_inputs(planted: float) -> None:
    """Of cohesive arms, on which the load is round there."""
    found = covered(COHESIVE, planted, KNOWN)
    assert set(found) == {"peak load", "initial stiffness", "propagation load", "load at 0.62"}
    assert all(0.9 <= part <= 0.99 for part in found.values()), found
