"""``debond certify``: runs, budgets, values of both codes, what is kept and what is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from math import hypot, nan

import numpy as np
import pytest

from tests.verify.checks.test_certified import END, run
from verify.cli import REFUSED, main
from verify.command_line.answers import FAILED
from verify.runs.jobs import Job, Outcome
from verify.scene.load import load_scene
from verify.scene.stated.certified import entries, problem_key
from verify.studies.certified import keeping, study
from verify.studies.certified.study import RESOLUTION, Study, planned
from verify.studies.certified.values import BUDGET_SHARES, OfCode, Value, of_code, shared
from verify.studies.uncertainty import Part, Plan
from verify.support.refusal import Refusal

SCENE = "dcb-czm1"


def answered(plan: Plan, off: float = 0.0, matched: float = 0.0) -> dict[Job, Outcome]:
    """Meshes of second order with a limit of 1; DOLFINx is ``off``, and pairs that are kept change ``matched``."""
    coarser = {job: i for runs in plan.codes.values() for i, job in enumerate(runs["mesh"])}

    def of(job: Job) -> Outcome:
        h, kept = RESOLUTION.ratio ** coarser.get(job, 0), matched * (job in plan.codes["nurbs"]["matched"])
        load = 1.0 + 1e-4 * h**2 + (off + matched) * (job.method == "dolfinx") + kept
        return Outcome(job, replace(run(job.method, load), elements=round(1000 / h), condition=1e6))

    return {job: of(job) for job in plan.jobs}


def judged(scene: str = SCENE, at: tuple[float, ...] = (), columns=lambda steps: steps, **offs: float) -> Study:
    plan = planned(scene, load_scene(scene), at)
    made = {
        job: Outcome(job, replace(one.result, steps=columns(one.result.steps)))
        for job, one in answered(plan, **offs).items()
    }
    return study.judged(plan, made)


def test_a_plan_has_three_meshes_of_two_codes_and_one_run_for_each_other_share():
    plan = planned(SCENE, load_scene(SCENE))
    assert len(plan.jobs) == 2 * (3 + 1 + 1) + 1 + 2 and plan.left_out == []
    for runs, key in zip(plan.codes.values(), ("discretization.dofs=", "dolfinx.elements="), strict=True):
        sizes = [float(one.removeprefix(key)) for job in runs["mesh"] for one in job.overrides if key in one]
        assert np.divide(sizes[:-1], sizes[1:]) == pytest.approx(RESOLUTION.ratio, rel=0.01)
        finest, halved, layers = (runs[name][0].solved for name in ("mesh", "steps", "thickness"))
        assert halved.discretization.bend == finest.discretization.bend / 4.0 and layers != finest
    first = plan.codes["nurbs"]
    assert first["matched"][0].solved.effects.search is False
    assert all(first[f"load.at={place}"][0].solved.load.at == place for place in ("face", "node", "hinge"))
    peel = planned("peel-120", load_scene("peel-120"), [2.0])
    assert not peel.codes["nurbs"]["matched"] and not peel.codes["nurbs"]["thickness"] and peel.at == (2.0,)
    assert ["keeps its pairs" in text for text in peel.left_out] == [True, False]


def test_a_budget_of_a_code_adds_squares():
    h = (1.0, 1.4, 1.96)
    values = {"mesh": [1.0 + 0.01 * x**2 for x in h], "steps": [1.012], "thickness": [1.0104]}
    one = of_code(values, h, 1e8, -0.5)
    sizes = [1.25 * 0.01, 4e-4, BUDGET_SHARES.halved * 2e-3, BUDGET_SHARES.newton * 1.01, 2.2e-16 * 1e8 * 1.01]
    assert [part.u for part in one.parts] == pytest.approx(sizes, rel=0.01)
    assert (one.uncertainty, *one.meshes[:2]) == pytest.approx((hypot(*sizes), 0.51, 0.5196), rel=1e-3)
    assert of_code(values | {"thickness": []}, h, 1e8).parts[1].u == 0.0


def both(first: tuple[float, float], second: tuple[float, float]) -> Value:
    """A load in two codes: value and uncertainty of each."""
    codes = {code: OfCode((Part("", "num", u),), (x,)) for code, (x, u) in {"a": first, "b": second}.items()}
    return Value("a load", "load_at", 1.0, codes)


@pytest.mark.parametrize(
    ("first", "second", "value", "uncertainty", "doubt"),
    [
        ((1.0, 5e-4), (1.0008, 1e-3), 1.00016, 6.4e-4, ""),  # nearer to the better code, as far as the worse one is
        ((1.0, 5e-4), (1.0, 1e-3), 1.0, 5e-4, ""),  # no better than the better code
        ((1.0, 1e-4), (1.001, 1e-4), 1.0005, 5e-4, "a 1 ± 0.0001 and b 1.001 ± 0.0001 differ by more than"),
        ((1.0, 4e-3), (1.0, 4e-3), 1.0, 4e-3, "its uncertainty is 0.40%, more than 0.25%"),
        ((nan, 1e-4), (1.0, 1e-4), nan, nan, "a run has no such value"),
    ],
)
def test_the_common_value_covers_both_codes_or_is_not_certified(first, second, value, uncertainty, doubt):
    one = both(first, second)
    assert value != value or (one.value, one.uncertainty) == pytest.approx((value, uncertainty))
    assert one.doubt.startswith(doubt) and bool(one.doubt) == bool(doubt) == ("not certified" in one.sentence)


def test_a_load_has_at_least_the_uncertainty_of_the_others():
    """Meshes that agree at one opening by chance certify no load there better than elsewhere."""
    lucky, usual, bad = (both((x, u), (x, u)) for x, u in ((2.0, 1e-6), (1.0, 1e-3), (1.0, 1e-2)))
    first, second, third, peak = shared([lucky, usual, bad, replace(lucky, kind="peak")])
    assert [one.uncertainty for one in (first, second, peak)] == pytest.approx([2e-3, 1e-3, 1e-6]) and third.doubt


def test_codes_that_solve_two_models_are_compared_on_one():
    found, wrong = judged(matched=0.004), judged(off=0.002)
    peak = found.found[0]
    assert found.complete and peak.matched == pytest.approx(0.004 * peak.value, rel=1e-3) and peak.apart < 1e-6
    assert peak.value == pytest.approx(1.0001 * 0.24525, rel=1e-4)
    assert all("differ by more" in one.doubt for one in wrong.found if one.kind in ("peak", "load_at", "work"))


@pytest.mark.parametrize(
    ("columns", "at", "said"),
    [
        (lambda steps: {key: steps[key] for key in ("opening", "load")}, (), "length of the process zone: left out"),
        (lambda steps: steps, (1e-3,), "load at 0.001: left out: the specimen bears less than"),
        (lambda steps: steps | {"load": steps["opening"]}, (), "opening at the peak: left out: the load still grows"),
    ],
)
def test_a_quantity_that_lacks_is_said(columns, at, said):
    assert any(text.startswith(said) for text in judged(at=at, columns=columns).left_out)


def test_what_is_kept_replaces_what_was_there(tmp_path, monkeypatch):
    """NURBS cannot keep the pairs of a peel test, and nothing moves where the surfaces are not searched."""
    monkeypatch.setattr(study.frame, "failure", lambda _: "")  # the curve is that of no peel test
    file, page, key = tmp_path / "certified.json", tmp_path / "certified.md", problem_key(load_scene(SCENE))
    file.write_text('{"old": {"scene": "a", "units": "u", "values": []}}')
    page.write_text(f"# Title\n\n{keeping.BEGIN}\n{keeping.END}\n\nbelow\n")
    for scene, at in ((SCENE, ()), (SCENE, ()), (f"{SCENE}-linear", (END / 2,)), ("peel-120", (END / 2,))):
        keeping.keep(judged(scene, at), file, page)
    known, text = json.loads(file.read_text()), page.read_text()
    assert len(known) == 4 and len(known[key]["values"]) == 8 and known["old"]
    assert text.count(f"`{SCENE}`") == 1 and text.endswith("\n\nbelow\n") and "| peak load | 0.24" in text
    assert "| not known |" in text and "| +0 |" in text and "| `peel-60` | none: not tried |" in text
    keeping.keep(judged(off=0.5), file, page)
    assert {one["kind"] for one in json.loads(file.read_text())[key]["values"]} <= {"peak_opening", "zone"}
    assert "| peak load: not certified: nurbs" in page.read_text(), "the table says why a quantity lacks"


def test_the_guide_shows_what_the_package_has():
    text = keeping.GUIDE_PAGE.read_text(encoding="utf-8")
    assert keeping.with_table(text, entries()) == text


def test_the_command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["certify", SCENE, "--dry-run"]) == 0 and "13 of 13 runs" in capsys.readouterr().out
    assert main(["certify", SCENE, "--at", "4"]) == REFUSED
    assert "--at: must be > 0 and <= 3, the largest opening, got 4" in capsys.readouterr().err
    with pytest.raises(Refusal, match="load.opening: must only grow from 0 on for debond certify"):
        planned(SCENE, load_scene(SCENE, ["load.opening=[1.0, 0.5, 2.0]"]))
    plan = planned(SCENE, load_scene(SCENE))
    monkeypatch.setattr(study.frame, "write_page", lambda *_: None)
    for off, code in ((0.0, 0), (0.002, FAILED)):
        monkeypatch.setattr(study.frame, "run", lambda *_, off=off: answered(plan, off))
        assert main(["certify", SCENE, "--out", "here"]) == code
    written = json.loads((tmp_path / "here" / "certified.json").read_text())
    assert written["problem"] == problem_key(plan.scene) and len(written["values"]) == 8
    monkeypatch.setattr(keeping, "GUIDE_PAGE", tmp_path / "a" / "b" / "c" / "none.md")
    assert main(["certify", SCENE, "--keep"]) == REFUSED and "--keep: is for a checkout" in capsys.readouterr().err
