"""``debond validate``: quantities, budgets, the runs, what is refused, files and exit codes."""

from __future__ import annotations

import json
from collections.abc import Callable
from math import nan
from pathlib import Path

import numpy as np
import pytest

from verify.cli import REFUSED, main
from verify.command_line.answers import FAILED
from verify.curves.of_run import cubics
from verify.methods.solve import solve
from verify.result import Result
from verify.runs.jobs import Job, Outcome
from verify.scene.load import load_scene
from verify.studies.validation import study as validation
from verify.studies.validation.band import band
from verify.studies.validation.budget import ESTIMATES, Moved, of_data, of_input, of_introduction, of_meshes
from verify.studies.validation.plan import LOAD_PLACES, planned
from verify.studies.validation.quantities import Quantity, quantities
from verify.studies.validation.scales import other_units
from verify.studies.validation.statement import COVERAGE, Curves, Known, Statement, statement
from verify.support.refusal import Refusal

STATED = ("material.young", "specimen.arm_thickness", "specimen.precrack", "interface.toughness")
D = np.linspace(0.0, 3.0, 301)


def peaked(scale: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    return D, scale * D * np.exp(-2.0 * D)


@pytest.mark.parametrize(("thickness", "toughness"), [(0.2, 0.1), (0.04, 0.0008)])
def test_sensitivities_are_the_exponents_of_closed_forms(thickness: float, toughness: float) -> None:
    """Slender arms: stiffness E h^3 a^-3, peak sqrt(G E h^3) / a, propagation (G^3 E h^3)^(1/4) d^(-1/2); a stocky arm
    deforms in shear as well, and its exponents of h and of a are still as far from these as each other."""
    given = [f"specimen.arm_thickness={thickness}", f"interface.toughness={toughness}"]
    given += [f"uncertainty.{key}=0.01" for key in STATED]
    plan = planned("dcb-czm1-linear", load_scene("dcb-czm1-linear", given), "lefm", given)
    outcome = {job: Outcome(job, solve(job.solved, "lefm")) for job in plan.jobs}
    curves = Curves(
        cubics(outcome[plan.base].result),
        {key: (u, *(cubics(outcome[job].result) for job in pair)) for key, (u, *pair) in plan.inputs.items()},
    )
    known = Known(plan.known.inputs, {"data.load": 0.01, "data.opening": 0.01})
    found = {one.name: statement(one, curves, curves.scene, known) for one in quantities(curves.scene, curves.scene)[0]}
    slopes = {name: {part.name: part.sensitivity for part in one.parts} for name, one in found.items()}
    keys = (*STATED, "data.load", "data.opening")
    exact = {"initial stiffness": (1, 3, -3, 0, 1, -1), "propagation load": (0.25, 0.75, 0, 0.75, 1, 0.5)}
    exact["peak load"] = (0.5, 1.5, -1, 0.5, 1, 0)
    near = 0.01 if thickness < 0.1 else 0.04
    for name, numbers in exact.items():
        got = [slopes[name][key] for key in keys]
        assert got == pytest.approx(numbers, rel=near, abs=0.005), name
    stiff = slopes["initial stiffness"]
    assert stiff["specimen.arm_thickness"] == pytest.approx(-stiff["specimen.precrack"], rel=1e-3)


def test_a_budget_adds_squares_and_a_mesh_that_is_exact_adds_nothing() -> None:
    curves = Curves(
        peaked(),
        {"a.b": (0.02, peaked(0.98), peaked(1.02))},
        [(1.0, peaked()), (1.3, peaked()), (1.69, peaked())],
        {"face": peaked(), "node": peaked(1.01), "hinge": peaked(0.99)},
    )
    known = Known({"a.b": 0.04}, {"data.load": 0.03, "data.opening": 0.0})
    one = statement(Quantity("peak load", "", lambda curve: float(np.max(curve[1]))), curves, peaked(0.9), known)
    top = 0.5 * np.exp(-1.0)
    parts = {"num": 0.0, "input": 0.04 * top, "introduction": 0.02 * top / np.sqrt(12.0), "data": 0.03 * 0.9 * top}
    assert {kind: one.of(kind) for kind in parts} == pytest.approx(parts)
    u = np.sqrt(sum(part**2 for part in parts.values()))
    assert (one.E, one.u_val) == pytest.approx((0.1 * top, u))
    assert one.interval == pytest.approx((0.1 * top - COVERAGE * u, 0.1 * top + COVERAGE * u))
    assert one.resolved and "the model shows more than the data" in one.sentence and not one.doubt and not one.remarks
    load, around = band(curves, known, D)
    i = int(np.argmax(load))
    assert around[i] == pytest.approx(np.sqrt(u**2 + (0.03 * top) ** 2 - parts["data"] ** 2), rel=1e-6)


def test_the_mesh_counts_by_its_index_and_by_first_order_where_it_has_none() -> None:
    h = np.array([1.0, 1.3, 1.69])
    second = of_meshes(h, 1.0 + 0.01 * h**2)
    assert not second.doubtful and second.u == pytest.approx(1.25 * 0.01 / ESTIMATES.expansion, rel=1e-6)
    chance = of_meshes(h, [1.0, 1.0 + 1e-9, 1.02])  # two meshes that agree by chance have the error of three
    assert not chance.doubtful and chance.u == pytest.approx(1.25 * 0.02 / (1.3**4 - 1.0) / ESTIMATES.expansion)
    to_and_fro = of_meshes(h, np.array([1.0, 1.01, 1.0]))
    assert to_and_fro.doubtful and to_and_fro.u == pytest.approx(3.0 * 0.01 / 0.69 / ESTIMATES.expansion)
    assert of_meshes([1.0, 1.0, 1.3], [1.0, 1.0, 1.0]).doubtful


def test_meshes_that_make_most_of_it_leave_no_statement() -> None:
    mesh = of_meshes([1.0, 1.3, 1.69], [1.0, 1.01, 1.0])
    lone = Statement("peak load", "", 1.0, 1.0, (mesh, of_input("a.b", 0.01, Moved(0.01, 0.99, 1.0, 1.01))))
    assert "not in the asymptotic range" in lone.doubt and lone.sentence.endswith("take finer ones")
    wide = Statement("peak load", "", 1.0, 2.0, (mesh, of_input("a.b", 0.3, Moved(0.01, 0.99, 1.0, 1.01))))
    assert wide.doubt == "" and wide.resolved and "less than the data" in wide.verdict
    assert Statement("peak load", "", nan, 1.0, ()).doubt


def test_an_input_that_is_not_linear_is_said_where_it_counts() -> None:
    bent = of_input("a.b", 0.1, Moved(0.1, 0.9, 1.0, 0.95))
    assert not bent.straight and "not linear in a.b" in Statement("peak load", "", 1.0, 1.0, (bent,)).remarks[0]
    large = of_introduction({"face": 1.0, "node": 5.0})
    assert Statement("peak load", "", 1.0, 1.0, (bent, large)).remarks == []
    assert of_data({"data.load": 0.0, "data.opening": 0.0}, 1.0, 1.0) == ()


def test_a_quantity_that_a_curve_lacks_is_left_out_with_a_sentence() -> None:
    rising = D, D**2
    names = [one.name for one in quantities(rising, rising, [9.0])[0]]
    said = quantities(rising, rising, [9.0])[1]
    assert names == ["initial stiffness"]
    starts = ("peak load: left out: the load of the simulation and of the data still", "propagation load", "load at 9")
    assert all(text.startswith(start) for text, start in zip(said, starts, strict=True))
    assert [one.name for one in quantities(peaked(), peaked(), [2.0])[0]][-1] == "load at 2"


@pytest.mark.parametrize("slack", [0.0, 0.03, 0.15, -0.03])
def test_slack_of_a_test_does_not_count_in_its_stiffness_and_an_error_of_the_model_does(slack: float) -> None:
    """The model softens from the start, so that a window of openings would show it another part of the curve."""
    d, P = peaked()
    stiffness = {}
    for error in (0.0, 0.05):
        data = np.append(0.0, (1.0 + error) * d + slack)[slack < 0.0 :], np.append(0.0, P)[slack < 0.0 :]
        one = {one.name: one for one in quantities((d, P), data)[0]}["initial stiffness"]
        stiffness[error] = one.of((d, P)) / one.of(data) - 1.0
    assert list(stiffness.values()) == pytest.approx([0.0, 0.05], abs=1e-12)


def test_data_of_too_few_rows_have_no_stiffness_and_no_peak() -> None:
    """A row at half of the peak load, and none before; all rows but those beside the peak."""
    at = np.array([0.0, 0.12, 0.5, 1.0, 3.0])
    names = [one.name for one in quantities(peaked(), (at, np.interp(at, *peaked())))[0]]
    assert "initial stiffness" not in names
    d, P = peaked()
    top = d[np.argmax(P)]
    for width, told in ((0.02, True), (0.3, False)):
        kept = np.abs(d - top) > width * top
        found, missing = quantities((d, P), (d[kept], P[kept]))
        assert ("peak load" in [one.name for one in found]) == told, missing
        assert told or "too few rows" in missing[0]


def test_every_run_differs_by_one_thing() -> None:
    given = ["uncertainty.interface.strength=0.1", "uncertainty.material.young=0.001", "effects.contact=auto"]
    scene = load_scene("dcb-czm1", given)
    plan = planned("dcb-czm1", scene, "nurbs", given)
    dofs = [job.solved.discretization.dofs for job in plan.meshes]
    assert dofs == [1956, 1505, 1157] and {job.solved.discretization.steps for job in plan.jobs} == {"auto"}
    assert len({job.solved.interface.penalty for job in plan.jobs}) == 1, "the contact stays as it is"
    assert all(isinstance(job.solved.effects.contact, bool) for job in plan.jobs), "no effect may flip"
    step, low, high = plan.inputs["interface.strength"]
    assert (step, low.solved.interface.strength, high.solved.interface.strength) == pytest.approx((0.1, 3.6, 4.4))
    assert plan.inputs["material.young"][0] == 0.005, "a smaller step would be that of Newton's tolerance"
    assert {place: job.solved.load.at for place, job in plan.places.items()} == {at: at for at in LOAD_PLACES}
    assert len(plan.jobs) == 3 + 2 * 2 + 2


def test_what_has_one_place_of_the_load_or_no_mesh_is_said() -> None:
    plan = planned("dcb-czm1-linear", load_scene("dcb-czm1-linear"), "beam")
    assert len(plan.jobs) == 1 and [text.partition(":")[0] for text in plan.left_out] == [
        "load introduction", "mesh", "inputs", "data",
    ]  # fmt: skip
    closed = load_scene("dcb-czm1-linear", ["uncertainty.introduction=false"])
    assert planned("dcb-czm1-linear", closed, "nurbs").places == {}


def test_an_input_that_the_scene_does_not_take_is_refused() -> None:
    given = ["specimen.precrack=13.0", "uncertainty.specimen.precrack=0.1"]
    with pytest.raises(Refusal, match=r"uncertainty.specimen.precrack: .*specimen.precrack: must be .* times"):
        planned("dcb-czm1", load_scene("dcb-czm1", given), "nurbs", given)


@pytest.fixture
def lab(tmp_path: Path) -> Path:
    solved = solve(load_scene("dcb-czm1-linear", ["interface.toughness=0.103"]), "lefm")
    np.savetxt(
        tmp_path / "lab.csv", np.stack([solved.opening, solved.load], 1), delimiter=",", header="U,F", comments=""
    )
    return tmp_path / "lab.csv"


def run_here(monkeypatch: pytest.MonkeyPatch, solver: Callable[[Job], Result]) -> None:
    """Runs in this process."""

    def run(plan: list[Job], *_: object) -> dict[Job, Outcome]:
        return {job: Outcome(job, solver(job)) for job in plan}

    monkeypatch.setattr(validation.frame, "run", run)


def command(lab: Path, *more: str) -> list[str]:
    sets = [word for key in STATED for word in ("--set", f"uncertainty.{key}=0.02")]
    columns = ["--opening", "U", "--load", "F"]
    return ["validate", "dcb-czm1-linear", "--with", str(lab), *columns, "--method", "lefm", *sets, *more]


def test_it_writes_a_statement(lab: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture) -> None:
    run_here(monkeypatch, lambda job: solve(job.solved, "lefm"))
    out = lab.parent / "out"
    assert main(command(lab, "--set", "uncertainty.data.load=0.01", "--at", "1.5,7", "--out", str(out))) == 0
    printed = capsys.readouterr().out
    assert "peak load: S " in printed and "load at 7: left out" in printed and "u_val" in printed
    kept = json.loads((out / "validation.json").read_text())
    first = kept["statements"][0]
    assert first["quantity"] == "peak load" and first["E"] == pytest.approx(first["S"] - first["D"])
    assert {part["name"] for part in first["budget"]} == {*STATED, "data.load"} and not first["resolved"]
    assert len((out / "validation.csv").read_text().splitlines()) == 1 + len(kept["statements"]) == 5
    assert "Validation against lab" in (out / "report.html").read_text()


def test_a_run_that_stops_leaves_no_statement(lab: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    def solver(job: Job) -> Result:
        status = "stopped: Newton" if "toughness-larger" in job.variant else "complete"
        return Result("lefm", solve(job.solved, "lefm").steps, status)

    run_here(monkeypatch, solver)
    assert main(command(lab, "--out", str(lab.parent / "out"))) == FAILED
    assert "interface.toughness-larger: stopped: Newton" in capsys.readouterr().out


@pytest.mark.parametrize("scale", ["--opening-scale", "--load-scale"])
@pytest.mark.parametrize("factor", ["1000", "0.001"])
def test_data_in_other_units_leave_no_statement(scale: str, factor: str, lab: Path, monkeypatch, capsys) -> None:
    run_here(monkeypatch, lambda job: solve(job.solved, "lefm"))
    assert main(command(lab, scale, factor, "--out", str(lab.parent / "out"))) == FAILED
    printed = capsys.readouterr().out
    assert "no statement: the data open to " in printed and "units?" in printed and "told from zero" not in printed


def test_data_that_end_early_or_stand_on_a_plateau_are_in_no_other_units() -> None:
    """A peak anywhere on a plateau, and a largest load that is a small part of that of the simulation."""
    plateau = np.minimum(2.0 * D, 0.2)
    early, late = (D, plateau + 1e-9 * D * (D < 0.2)), (D, plateau + 1e-9 * D)
    assert other_units(early, late) == other_units(late, early) == ""
    assert other_units((D, 2.0 * D - 0.3 * D**2), (D[:20], 2.0 * D[:20])) == ""


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--with", "lab.csv", "--with", "b=lab.csv"], "--with: must name one curve"),
        ([], "--with: must name one curve"),
        (["--with", "nothing.csv"], "nothing.csv: must be a file"),
        (["--with", "lab.csv", "--method", "nubrs"], "--method: must be"),
        (["--with", "lab.csv", "--set", "uncertainty.material.yuong=0.1"], "uncertainty.material.yuong: must be"),
    ],
)
def test_bad_input_is_refused_before_any_work(words: list[str], sentence: str, lab: Path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(lab.parent)
    lab.write_text("opening,load\n0,0\n1,2\n3,1\n")
    assert main(["validate", "dcb-czm1-linear", *words]) == REFUSED
    assert sentence in capsys.readouterr().err and not (lab.parent / "debond-validation").exists()


def test_a_dry_run_lists_its_runs(lab: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(command(lab, "--dry-run", "--out", str(lab.parent / "out"))) == 0
    assert "9 of 9 runs to do" in capsys.readouterr().out and not (lab.parent / "out").exists()
