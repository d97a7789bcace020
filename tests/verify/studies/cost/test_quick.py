"""The quick ladder of a verification: its plan, what it says, where it is told."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from math import nan
from pathlib import Path

import pytest
from made_up_costs import SCENE, a_row, against, ladder, planted

from verify import verification
from verify.checks.judgement import NO_DEMANDS, judged
from verify.cli import main
from verify.methods.names import METHODS
from verify.runs import verdict_file
from verify.scene.load import load_scene
from verify.studies.cost import quick as quick_of
from verify.studies.cost import study as study_of
from verify.studies.cost.findings import LEVELS
from verify.studies.cost.ladder import FAMILIES, OF_SCENE
from verify.studies.cost.price import PRICED, UNFINISHED, Price
from verify.studies.cost.quick import QUICK, quick

ROWS = (
    a_row("nurbs", 0.002, 0.2, 432, 2, "auto-0.02"), a_row("nurbs", 0.001, 0.5, 504, 2),
    a_row("lagrange", 0.002, 0.4, 732, 2, "auto-0.02"),
    a_row("dolfinx", 0.0025, 0.9, 756, 2, "auto-0.02"), a_row("dolfinx", 0.002, 0.7, 1044, 2),
)  # fmt: skip
BEAMS = a_row("beam", 0.02, 0.01, 0, 0), a_row("beam-3", 0.0004, 0.04, 0, 0)


def said(rows: Sequence) -> str:
    return Price(SCENE, against(), tuple(rows)).sentence.replace("\u00a0", " ")


def test_the_price_is_that_of_the_cheapest_beside_dolfinx() -> None:
    """The beam has no mesh; a ratio at equal steps is of runs that were asked for equal steps."""
    assert said(ROWS) == (
        "0.3 % of the load curve of dcb-czm1 costs 0.2 s with NURBS p=2 of 432 unknowns and 0.7 s with DOLFINx p=2 of "
        "1044, 3.5 × as long; at equal steps 1.4 ×."
    )
    assert said((*ROWS, *BEAMS)) == (
        f"{said(ROWS)} The beam of order 1 takes 0.01 s and is 2 % off, that of order 3 takes 0.04 s and is 0.04 % off."
    )
    told = Price(SCENE, against(), ROWS).summary()
    assert told["ratio"] == pytest.approx(3.5) and told["ratio_at_equal_steps"] == pytest.approx(1.4)
    assert [(run["method"], run["dofs"], run["seconds"]) for run in told["runs"]] == [
        ("nurbs", 432, 0.2), ("dolfinx", 1044, 0.7),
    ]  # fmt: skip
    assert [run["seconds"] for run in told["at_equal_steps"]] == [0.5, 0.7] and told["curve_error"] == 0.003
    assert json.loads(json.dumps(told))["sentence"] == Price(SCENE, against(), ROWS).sentence


def test_where_dolfinx_is_the_cheapest_the_next_method_stands_beside_it() -> None:
    rows = (a_row("dolfinx", 0.002, 0.1, 756, 2, "auto"), *ROWS[:3])
    assert "costs 0.1 s with DOLFINx p=2 of 756 unknowns and 0.2 s with NURBS p=2 of 432, 2 × as long." in said(rows)


def test_what_is_missing_is_said() -> None:
    assert said(ROWS[:3]).endswith("of 432 unknowns; DOLFINx was not run.")
    assert said((*ROWS[:3], a_row("dolfinx", 0.02, 0.1, 200, 2))).endswith("; DOLFINx did not reach it.")
    alone = (a_row("dolfinx", 0.002, 0.1, 756, 2), a_row("nurbs", 0.02, 0.2))
    assert said(alone).endswith("of 756 unknowns; no other method reached it.")
    coarse = [replace(row, curve_error=0.008) for row in ROWS]
    assert said(coarse).startswith("1 % of the load curve of dcb-czm1 costs 0.2 s")
    none = Price(SCENE, against(), (a_row("nurbs", 0.02, 0.2), a_row("dolfinx", nan, 0.2)))
    assert "No run of the quick ladder on dcb-czm1 is within" in none.sentence
    assert none.summary()["runs"] == [] and none.summary()["ratio"] is None


def test_families_are_those_of_the_study() -> None:
    """And every run of the ladder has steps that follow the accuracy."""
    known = {(family.method, family.solver, family.degree) for family in FAMILIES}
    meshes = [family for family in QUICK.families if not family.beam]
    assert {(family.method, family.solver, family.degree) for family in meshes} <= known
    assert {family.solver for family in meshes} == {name for name, one in METHODS.items() if one.has_mesh}
    assert QUICK.ladder.rungs == 4 and str(QUICK.ladder.steps).startswith("auto")
    lines = quick_of.would_run("dcb-czm1", SCENE, Path("nowhere"))
    assert sum("dcb-czm1/cost/" in line for line in lines) == 4 * len(meshes) + len(BEAMS) or "not run" in " ".join(
        lines
    )


def test_the_ladder_is_a_small_study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("verify.methods.dolfinx.dolfinx_installed", lambda: True)
    asked = planted(monkeypatch, ladder)
    found = quick("dcb-czm1", SCENE, tmp_path, 1)
    assert found is not None and len(found.pair) == 2 == len(found.equal) and found.left_out == ()
    assert {row.method for row in found.rows} == {family.method for family in QUICK.families}
    assert all(row.times == QUICK.times for row in (*found.pair, *found.equal))
    assert len({job.place for job, *_ in asked}) == len(asked) <= 70
    assert {row.asked for row in found.rows} == {"auto-0.02", "auto-0.05", "80", OF_SCENE}
    for family in QUICK.families:  # an error below what is priced is of no use
        of_family = [row for row in found.rows if row.method == family.method and row.asked == "auto-0.02"]
        assert sum(row.curve_error <= study_of.LIMITS.enough * LEVELS[PRICED[0]] for row in of_family) <= 1, family


def test_a_ladder_that_takes_too_long_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = planted(monkeypatch, ladder)
    monkeypatch.setattr(quick_of, "QUICK", replace(QUICK, climb=0.0, vary=0.0, repeat=0.0))
    found = quick("dcb-czm1", SCENE, tmp_path, 1)
    assert found is not None and found.sentence.endswith(UNFINISHED) and len(asked) < 10


# --- which scene, and where it is told


def test_the_ladder_is_on_the_scene_of_the_paper_alone() -> None:
    """A scene of the user's own has none unless it is asked for, nor has this one with other values."""
    scenes = [(name, load_scene(name)) for name in ("peel-60", "dcb-czm2", "dcb-czm1", "dcb-czm1-linear")]
    assert verification.laddered(scenes) == [scenes[2]]
    assert verification.laddered(scenes[:2]) == []
    assert verification.laddered([("report/dcb-czm1/scene.toml", load_scene("dcb-czm1", ["load.opening=2.0"]))]) == []


@pytest.mark.parametrize(
    ("words", "names"),
    [
        ([], ["dcb-czm1"]),
        (["--set", "load.opening=2.0"], []),
        (["--no-ladder"], []),
        (["--ladder", "peel-60", "--ladder", "dcb-czm2"], ["peel-60", "dcb-czm2"]),
    ],
)
def test_options_choose_the_scenes(words: list[str], names: list[str], tmp_path: Path, monkeypatch) -> None:
    seen = []
    monkeypatch.setattr(verification, "would_run", lambda subjects, out, jobs: seen.append(subjects) or [])
    assert main(["verify", "dcb-czm1", *words, "--dry-run", "--out", str(tmp_path / "out")]) == 0
    assert [source for source, _ in seen[0].ladders] == names


def test_both_options_are_refused(capsys: pytest.CaptureFixture) -> None:
    assert main(["verify", "dcb-czm1", "--no-ladder", "--ladder", "peel-60"]) == 2
    assert "--no-ladder: must be left out with --ladder peel-60" in capsys.readouterr().err
    assert main(["verify", "dcb-czm1", "--ladder", "nothing"]) == 2


def test_the_verdict_has_the_price(tmp_path: Path) -> None:
    prices = [Price(SCENE, against(), ROWS), Price(load_scene("peel-60"), against(), ROWS)]
    for given in (prices, prices[:1], []):
        verdict_file.write(tmp_path, (), judged((), NO_DEMANDS), (), given)
        price = json.loads((tmp_path / "verdict.json").read_text())["price"]
        if not given:
            assert price is None
            continue
        assert price["sentence"] == prices[0].sentence and price["ratio"] == pytest.approx(3.5)
        assert [one["scene"] for one in price["others"]] == ["peel-60"][: len(given) - 1]


def test_a_dry_run_lists_the_ladder(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(["verify", "dcb-czm1", "--dry-run", "--out", str(tmp_path / "out")]) == 0
    assert "quick ladder on dcb-czm1, one run at a time:" in capsys.readouterr().out
