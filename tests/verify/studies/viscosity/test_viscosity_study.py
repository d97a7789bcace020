"""``debond viscosity``: its runs, what they tell, which scenes it refuses; and what slides in ``debond effects``."""

from __future__ import annotations

import numpy as np
import pytest

from verify.result import Result
from verify.runs.jobs import Outcome
from verify.scene.load import load_scene
from verify.studies.effects.plan import planned as effects_planned
from verify.studies.viscosity.plan import VISCOSITIES, planned
from verify.studies.viscosity.row import cheapest, rows
from verify.support.refusal import Refusal

SCENE = load_scene("enf-as4peek")


def made_up(higher: float, steps: int, seconds: float) -> Result:
    d = np.linspace(0.0, SCENE.load.opening[-1], steps + 1)
    load = (1.0 + higher) * d
    known = {"opening": d, "load": load, "external_work": 0.5 * load * d, "newton_iterations": np.ones(d.size)}
    return Result("nurbs", known, seconds={"total": seconds})


def test_runs_differ_by_the_viscosity_alone() -> None:
    """Without it damage would be reversible, and equal arms one, on a programme that only opens."""
    plan = planned("dcb-as4peek", load_scene("dcb-as4peek", ["effects.irreversible=auto"]), "nurbs")
    exact, *viscous = [job.solved for job in plan.jobs]
    assert [scene.interface.viscosity for scene in (exact, *viscous)] == [0.0, *VISCOSITIES]
    assert exact.effects.irreversible is True and exact.effects.shear is True
    assert all(replaced == exact for replaced in (_without(scene) for scene in viscous))


def _without(scene):
    return scene.model_copy(update={"interface": scene.interface.model_copy(update={"viscosity": 0.0})})


def test_a_scene_without_a_law_of_sliding_is_refused() -> None:
    with pytest.raises(Refusal, match="shear_strength"):
        planned("dcb-czm1", load_scene("dcb-czm1"), "nurbs")


def test_rows_are_against_the_run_without() -> None:
    plan = planned("enf-as4peek", SCENE, "nurbs")
    jobs = plan.jobs[:3]
    results = [made_up(0.0, 10, 2.0), made_up(0.1, 30, 6.0), made_up(0.5, 5, 1.0)]
    first = {job: Outcome(job, one) for job, one in zip(jobs, results, strict=True)}
    none, some, much = rows(jobs, first, {job: [outcome] for job, outcome in first.items()})
    assert (none.curve_error, none.peak_error, none.time_ratio) == (0.0, 0.0, 1.0)
    errors = (some.curve_error, some.peak_error, some.work_error)
    assert errors == pytest.approx((0.1, 0.1, 0.1)) and (some.time_ratio, some.steps_ratio) == (3.0, 3.0)
    assert "saves time from 0.0003 on: 0.5 x" in cheapest((none, some, much)) and "50 % off" in cheapest((none, much))
    assert cheapest((none, some)).startswith("no viscosity saves time")
    broken = first | {jobs[0]: Outcome(jobs[0], None, "not run: memory")}
    assert not any(one.complete for one in rows(jobs, broken, {job: [] for job in jobs}))


def test_effects_switch_what_slides() -> None:
    plan = effects_planned("enf-as4peek", load_scene("enf-as4peek"), "nurbs")
    last = {pair.switch.key: (pair.with_it.overrides, pair.without.overrides) for pair in plan.pairs}
    assert last["friction"] == (("interface.friction=0.3",), ()) and last["viscosity"][0] == (
        "interface.viscosity=0.01",
    )
    assert any(text.startswith("sliding: left out: effects.shear") for text in plan.left_out)
    given = ("interface.friction=0.1",)
    plan = effects_planned("enf-as4peek", load_scene("enf-as4peek", given), "nurbs", given)
    assert {pair.switch.key: pair.without.overrides for pair in plan.pairs}["friction"] == (
        *given,
        "interface.friction=0.0",
    )
    plan = effects_planned("dcb-as4peek", load_scene("dcb-as4peek"), "nurbs")
    assert "friction: left out: nothing slides" in plan.left_out
