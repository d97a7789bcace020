"""``debond certify``: runs, budgets, values of both codes, what is kept and what is refused."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from math import hypot
from pathlib import Path

import numpy as np
import pytest

from tests.verify.checks.test_certified import END, run
from verify.checks.certified import certified_check
from verify.cli import REFUSED, main
from verify.command_line.answers import FAILED
from verify.result import Result
from verify.runs.jobs import Job, Outcome
from verify.scene.load import load_scene
from verify.scene.stated.certified import entries, problem_key
from verify.studies.certified import keeping, study
from verify.studies.certified.budget import BUDGET_SHARES, OfCode, Seen, Value, of_code, shared
from verify.studies.certified.plan import RESOLUTION, Plan, planned
from verify.support.refusal import Refusal

SCENE = "dcb-czm1"


def code(value: float, uncertainty: float) -> OfCode:
    return OfCode(value, ((1.0, value),), {"mesh": uncertainty}, "")


def both(first: OfCode, second: OfCode, **other: object) -> Value:
    return Value("peak load", "peak", None, {"nurbs": first, "dolfinx": second}, **other)  # type: ignore[arg-type]


def answered(plan: Plan, off: float = 0.0, matched: float = 0.0) -> dict[Job, Outcome]:
    """Meshes of second order with a limit of 1; DOLFINx is ``off``, and pairs that are kept change ``matched``."""

    coarser = {job: i for made in plan.codes.values() for i, job in enumerate(made.meshes)}

    def of(job: Job) -> Outcome:
        h = RESOLUTION.ratio ** coarser.get(job, 0)
        changed = (off + matched) * (job.method == "dolfinx") + matched * (job == plan.matched)
        return Outcome(
            job, replace(run(job.method, 1.0 + 1e-4 * h**2 + changed), elements=round(1000 / h), condition=1e6)
        )

    return {job: of(job) for job in plan.jobs}


def test_a_plan_has_three_meshes_of_two_codes_and_one_run_for_each_other_share() -> None:
    plan = planned(SCENE, load_scene(SCENE))
    assert len(plan.jobs) == 2 * (3 + 1 + 1) + 1 + 2 and plan.left_out == ()
    for made, key in zip(plan.codes.values(), ("discretization.dofs", "dolfinx.elements"), strict=True):
        sizes = [int(next(one for one in job.overrides if one.startswith(key)).split("=")[1]) for job in made.meshes]
        assert all(1.3 < fine / coarse < 1.5 for fine, coarse in zip(sizes, sizes[1:], strict=False))
        assert made.paced.overrides != made.meshes[0].overrides and made.layered is not None
    assert plan.matched is not None and plan.matched.solved.effects.search is False
    assert set(plan.places) == {"node", "hinge"} and plan.at == tuple(END * part for part in RESOLUTION.parts)
    assert planned(f"{SCENE}-linear", load_scene(f"{SCENE}-linear")).matched is None
    peel = planned("peel-120", load_scene("peel-120"), [2.0])
    assert peel.matched is None and peel.at == (2.0,) and peel.codes["nurbs"].layered is None
    assert any("keeps its pairs" in text for text in peel.left_out)


@pytest.mark.parametrize(
    ("given", "at", "sentence"),
    [
        (["load.opening=[1.0, 0.5, 2.0]"], [], "load.opening: must only grow from 0 on for debond certify"),
        ([], [9.0], "--at: must be > 0 and <= 3, the largest opening, got 9"),
    ],
)
def test_what_has_no_certified_values_is_refused(given: list[str], at: list[float], sentence: str) -> None:
    with pytest.raises(Refusal, match=sentence.replace("[", r"\[")):
        planned(SCENE, load_scene(SCENE, given), at, given)


def test_a_budget_of_a_code_adds_squares() -> None:
    h = (1.0, 1.4, 1.96)
    found = of_code(Seen([(x, 1.0 + 0.01 * x**2) for x in h], 1.012, 1.0104, 1e8), -0.5)
    assert found.parts["mesh"] == pytest.approx(1.25 * 0.01)
    assert found.parts["thickness"] == pytest.approx(4e-4) and found.parts["steps"] == pytest.approx(
        BUDGET_SHARES.halved * 2e-3
    )
    assert 0.0 < found.parts["iteration"] < 1e-8 and 0.0 < found.parts["rounding"] < 1e-7
    assert found.uncertainty == pytest.approx(hypot(*found.parts.values()))
    assert found.value == pytest.approx(0.51) and found.meshes[1][1] == pytest.approx(0.5196)


def test_the_value_lies_nearer_to_the_better_code_and_its_uncertainty_covers_both() -> None:
    one = both(code(1.0, 0.0005), code(1.0008, 0.001))
    assert one.value == pytest.approx(1.0 + 0.0008 / 5.0)
    assert one.uncertainty == pytest.approx(0.0008 * 4.0 / 5.0), "as far as the worse code is"
    assert both(code(1.0, 0.0005), code(1.0, 0.001)).uncertainty == 0.0005, "no better than the better code"
    assert not one.why_not and one.sentence == "peak load: 1.00016 ± 0.00064 (0.064%)"


def test_a_load_has_at_least_the_uncertainty_of_the_others() -> None:
    """Meshes that agree at one opening by chance certify no load there better than elsewhere."""
    lucky, usual = both(code(2.0, 1e-6), code(2.0, 1e-6)), both(code(1.0, 1e-3), code(1.0, 1e-3))
    bad = both(code(1.0, 1e-2), code(1.0, 1e-2))
    loads = [replace(one, kind="load_at", opening=1.0) for one in (lucky, usual, bad)]
    first, second, third, peak = shared([*loads, lucky])
    assert first.uncertainty == pytest.approx(2e-3) and second.uncertainty == pytest.approx(1e-3)
    assert third.why_not and peak.uncertainty == pytest.approx(1e-6)


def test_codes_that_differ_by_more_than_they_say_certify_nothing() -> None:
    apart = both(code(1.0, 1e-4), code(1.001, 1e-4))
    assert "not certified: nurbs 1 ± 0.0001 and dolfinx 1.001 ± 0.0001 differ by more than" in apart.sentence
    assert "its uncertainty is 0.40%, more than 0.25%" in both(code(1.0, 4e-3), code(1.0, 4e-3)).why_not
    assert both(code(float("nan"), 1e-4), code(1.0, 1e-4)).why_not == "a run has no such value"


def test_codes_that_solve_two_models_are_compared_on_one() -> None:
    plan = planned(SCENE, load_scene(SCENE))
    found = study.judged(plan, answered(plan, matched=0.004))
    assert found.complete, found.lines()
    peak = found.values[0]
    assert peak.matched == pytest.approx(0.004 * peak.value, rel=1e-3)
    assert peak.value == pytest.approx(1.0001 * 0.24525, rel=1e-4) and peak.apart < 1e-6
    wrong = study.judged(plan, answered(plan, off=0.002))
    loads = [one for one in wrong.values if one.kind in ("peak", "load_at", "work")]
    assert not wrong.complete and all("differ by more" in one.why_not for one in loads)


def test_what_no_run_shows_of_kept_pairs_is_not_said_to_be_zero(monkeypatch: pytest.MonkeyPatch) -> None:
    """NURBS cannot keep the pairs of a peel test, and nothing moves where the surfaces are not searched."""
    monkeypatch.setattr(study.frame, "failure", lambda _: "")  # the curve of a beam is that of no peel test
    for scene, change, said in (("peel-120", None, "| not known"), (f"{SCENE}-linear", 0.0, "| +0")):
        plan = planned(scene, load_scene(scene), [END / 2])
        found = study.judged(plan, answered(plan))
        assert {one.matched for one in found.kept} == {change}
        entry = {"scene": scene, "units": "", "values": [asdict(one) for one in found.kept]}
        assert said in "".join(keeping.table([entry]))
        assert certified_check("other code", run(), replace(found.kept[0], matched=change), 1.0, None).passed


def test_a_run_that_fails_certifies_nothing_and_a_quantity_that_lacks_is_said() -> None:
    plan = planned(SCENE, load_scene(SCENE))
    outcomes = answered(plan)
    lost = plan.codes["dolfinx"].meshes[2]
    failed = study.judged(plan, outcomes | {lost: Outcome(lost, None, "failed: why", failed=True)})
    assert failed.values == () and failed.failures == (f"{lost.variant}: failed: why",)
    plain = {
        job: Outcome(job, replace(run(columns=False), elements=one.result.elements)) for job, one in outcomes.items()
    }
    assert any(text.startswith("length of the process zone: left out") for text in study.judged(plan, plain).left_out)
    plan = planned(SCENE, load_scene(SCENE), [1e-3])
    assert any("bears less than" in text for text in study.judged(plan, answered(plan)).left_out)


def test_what_is_kept_replaces_what_was_there(tmp_path: Path) -> None:
    plan = planned(SCENE, load_scene(SCENE))
    file, page = tmp_path / "certified.json", tmp_path / "certified.md"
    file.write_text('{"old": {"scene": "a", "units": "u", "values": []}}')
    page.write_text(f"# Title\n\n{keeping.BEGIN}\n{keeping.END}\n\nbelow\n")
    found = study.judged(plan, answered(plan))
    for _ in range(2):
        keeping.keep(found, file, page)
        entries.cache_clear()
    known = json.loads(file.read_text())
    assert list(known) == ["old", problem_key(plan.scene)] and len(known[problem_key(plan.scene)]["values"]) == 8
    assert page.read_text().count("`dcb-czm1`") == 1 and page.read_text().endswith("\n\nbelow\n")
    assert "| peak load | 0.24" in page.read_text()
    keeping.keep(study.judged(plan, answered(plan, off=0.5)), file, page)
    apart = json.loads(file.read_text())[problem_key(plan.scene)]
    assert {one["kind"] for one in apart["values"]} <= {"peak_opening", "zone"}
    assert any("peak load: not certified: nurbs" in text for text in apart["remarks"])
    assert "| peak load: not certified: nurbs" in page.read_text(), "the table says why a quantity lacks"
    assert "| `peel-120` | none: not tried |" in page.read_text(), "and names every packaged scene"


def test_the_guide_shows_what_the_package_has() -> None:
    text = keeping.GUIDE_PAGE.read_text(encoding="utf-8")
    assert keeping.with_table(text, entries()) == text


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["certify", SCENE, "--dry-run"]) == 0 and "13 of 13 runs" in capsys.readouterr().out
    assert main(["certify", SCENE, "--at", "4"]) == REFUSED
    plan = planned(SCENE, load_scene(SCENE))
    monkeypatch.setattr(study.frame, "write_page", lambda *_: None)
    for off, code in ((0.0, 0), (0.002, FAILED)):
        monkeypatch.setattr(study.frame, "run", lambda jobs, *_, off=off: answered(plan, off))
        assert main(["certify", SCENE, "--out", "here"]) == code
    written = json.loads((tmp_path / "here" / "certified.json").read_text())
    assert written["problem"] == problem_key(plan.scene) and len(written["values"]) == 8
    assert set(written["values"][0]["codes"]["nurbs"]["parts"]) >= {
        "mesh",
        "thickness",
        "steps",
        "iteration",
        "rounding",
    }
    monkeypatch.setattr(keeping, "GUIDE_PAGE", tmp_path / "a" / "b" / "c" / "none.md")
    assert main(["certify", SCENE, "--keep"]) == REFUSED and "--keep: is for a checkout" in capsys.readouterr().err


def test_a_load_that_still_grows_has_no_peak() -> None:
    plan = planned(SCENE, load_scene(SCENE))
    d = np.linspace(0.0, END, 50)
    grown = {job: Outcome(job, Result("x", {"opening": d, "load": d}, elements=10)) for job in plan.jobs}
    assert any(text.startswith("opening at the peak: left out") for text in study.judged(plan, grown).left_out)
