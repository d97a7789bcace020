"""``debond validate``: quantities, budgets, the runs, what is refused, files and exit codes."""

from __future__ import annotations

import json
import re
from math import hypot, nan
from types import SimpleNamespace

import numpy as np
import pytest

from verify.cli import REFUSED, main
from verify.command_line.answers import FAILED
from verify.curves.of_run import cubics
from verify.methods.solve import solve
from verify.runs.jobs import Outcome
from verify.scene.load import load_scene
from verify.scene.stated.uncertainty import Uncertainty
from verify.studies.uncertainty import LOAD_PLACES, Part, of_meshes, values
from verify.studies.validation import study as validation
from verify.studies.validation.quantities import Quantity, other_units, quantities, slack
from verify.studies.validation.statement import ESTIMATES, Statement, of_input, statement
from verify.studies.validation.study import planned
from verify.support.refusal import Refusal

STATED = ("material.young", "specimen.arm_thickness", "specimen.precrack", "interface.toughness")
D = np.linspace(0.0, 3.0, 301)
H = np.array([1.0, 1.3, 1.69])


def peaked(scale: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    return D, scale * D * np.exp(-2.0 * D)


def names(simulated, data, at=()) -> list[str]:
    return [one.name for one in quantities(simulated, data, at)[0]]


def of(*parts: Part, S: float = 1.0, D: float = 1.0) -> Statement:
    return Statement(parts, "peak load", "", S, D)


@pytest.mark.parametrize(("thickness", "toughness"), [(0.2, 0.1), (0.04, 0.0008)])
def test_sensitivities_are_the_exponents_of_closed_forms(thickness, toughness):
    """Slender arms: stiffness E h^3 a^-3, peak sqrt(G E h^3) / a, propagation (G^3 E h^3)^(1/4) d^(-1/2); a stocky arm
    deforms in shear as well, and its exponents of h and of a are still as far from these as each other."""
    given = [f"specimen.arm_thickness={thickness}", f"interface.toughness={toughness}"]
    given += [f"uncertainty.{key}=0.01" for key in (*STATED, "data.load", "data.opening")]
    plan = planned("dcb-czm1-linear", load_scene("dcb-czm1-linear", given), "lefm", given)
    curves = values(plan.codes["lefm"], lambda job: cubics(solve(job.solved, "lefm")))
    curve, stated = curves["mesh"][0], plan.scene.uncertainty
    slopes = {
        one.name: {part.name: part.sensitivity for part in statement(one, curves, (), curve, stated).parts}
        for one in quantities(curve, curve)[0]
    }
    exact = {"initial stiffness": (1, 3, -3, 0, 1, -1), "propagation load": (0.25, 0.75, 0, 0.75, 1, 0.5)}
    exact["peak load"] = (0.5, 1.5, -1, 0.5, 1, 0)
    for name, numbers in exact.items():
        assert list(slopes[name]) == [*stated.inputs, *stated.data]
        assert list(slopes[name].values()) == pytest.approx(numbers, rel=0.01 if thickness < 0.1 else 0.04, abs=0.005)
    stiff = slopes["initial stiffness"]
    assert stiff["specimen.arm_thickness"] == pytest.approx(-stiff["specimen.precrack"], rel=1e-3)


def test_a_budget_adds_squares_and_a_mesh_that_is_exact_adds_nothing():
    curves = {"mesh": [peaked()] * 3, "a.b": [peaked(0.96), peaked(1.04)]}
    curves |= {f"load.at={place}": [peaked(scale)] for place, scale in (("face", 1), ("node", 1.01), ("hinge", 0.99))}
    stated = Uncertainty.model_validate({"a.b": 0.04, "data.load": 0.03})
    one = statement(Quantity("peak load", "", lambda curve: float(np.max(curve[1]))), curves, H, peaked(0.9), stated)
    top = 0.5 * np.exp(-1.0)
    parts = {"num": 0.0, "input": 0.04 * top, "introduction": 0.02 * top / 12.0**0.5, "data": 0.03 * 0.9 * top}
    assert {kind: one.of(kind) for kind in parts} == pytest.approx(parts)
    u = hypot(*parts.values())
    assert (one.E, one.u_val, *one.model_error) == pytest.approx((0.1 * top, u, 0.1 * top - 2 * u, 0.1 * top + 2 * u))
    assert one.resolved and "the model shows more than the data" in one.sentence and not one.doubt and not one.remarks


@pytest.mark.parametrize(
    ("load", "error", "doubtful"),
    [
        (1.0 + 0.01 * H**2, 1.25 * 0.01, False),
        ([1.0, 1.0 + 1e-9, 1.02], 1.25 * 0.02 / (1.3**4 - 1.0), False),  # two agree by chance: the error of three
        ([1.0, 1.01, 1.0], 3.0 * 0.01 / 0.69, True),
    ],
)
def test_the_mesh_counts_by_its_index_and_by_first_order_where_it_has_none(load, error, doubtful):
    part = of_meshes(H, load, ESTIMATES.expansion)
    assert part.doubtful is doubtful and part.u == pytest.approx(error / ESTIMATES.expansion, rel=1e-6)


def test_what_makes_a_statement_doubtful_or_is_remarked_counts_only_where_it_is_much_of_u_val():
    mesh, bent = of_meshes(H, [1.0, 1.01, 1.0]), of_input("a.b", 0.1, 0.9, 1.0, 0.95)
    small, large = (Part("b", "input", u) for u in (0.01, 0.8))
    assert "not in the asymptotic range" in of(mesh, small).doubt and of(mesh, small).sentence.endswith("finer ones")
    wide = of(mesh, large, D=3.0)
    assert not wide.doubt and wide.resolved and "less than the data" in wide.sentence
    assert "not linear in a.b" in of(bent).remarks[0] and of(bent, large).remarks == [] and of(S=nan).doubt


def test_the_verdict_says_first_what_is_off_and_what_agrees():
    def of(name: str, S: float, u: float) -> Statement:
        return Statement((Part("x", "input", u),), name, "", S, 1.0)

    found = of("peak load", 1.11, 0.035), of("initial stiffness", 1.01, 0.02), of("load at 3", 0.8, 0.05)
    study = SimpleNamespace(found=(*found, of("load at 4", float("nan"), 0.1)), data=SimpleNamespace(name="lab"))
    assert validation.Study.verdict.fget(study) == (
        "the model against lab: peak load is 4 to 18 % too high; load at 3 is 10 to 30 % too low; initial stiffness "
        "agrees as far as can be told; load at 4 cannot be judged"
    )


@pytest.mark.parametrize("off", [0.0, 0.05, -0.03])
def test_the_toe_of_the_data_is_said_where_it_counts(off):
    d, P = D, np.minimum(D, 1.2 - 0.2 * D)
    said = slack((d + off * d[np.argmax(P)], P))
    assert len(said) == (off != 0.0)
    if said:
        assert float(re.search(r", (\S+)% of the opening", said[0])[1]) == pytest.approx(100.0 * off, rel=0.15)


def test_a_quantity_that_a_curve_lacks_is_left_out_with_a_sentence():
    rising, at = (D, D**2), np.array([0.0, 0.12, 0.5, 1.0, 3.0])
    said = quantities(rising, rising, [9.0])[1]
    starts = ("peak load: left out: the load of the simulation and of the data still", "propagation load", "load at 9")
    assert names(rising, rising) == ["initial stiffness"]
    assert all(text.startswith(start) for text, start in zip(said, starts, strict=True))
    assert names(peaked(), peaked(), [2.0])[-1] == "load at 2" and names(peaked(), peaked(-1.0)) == []
    assert "initial stiffness" not in names(peaked(), (at, np.interp(at, *peaked()))), "no row before half of the peak"
    d, P = peaked()
    for width, told in ((0.02, True), (0.3, False)):  # all rows but those beside the peak
        kept = np.abs(d - 0.5) > width * 0.5
        assert ("peak load" in names((d, P), (d[kept], P[kept]))) == told


@pytest.mark.parametrize("slack", [0.0, 0.03, 0.15, -0.03])
def test_slack_of_a_test_does_not_count_in_its_stiffness_and_an_error_of_the_model_does(slack):
    """The model softens from the start, so that a window of openings would show it another part of the curve."""
    d, P = peaked()
    for error in (0.0, 0.05):
        data = np.append(0.0, (1.0 + error) * d + slack)[slack < 0.0 :], np.append(0.0, P)[slack < 0.0 :]
        one = {one.name: one for one in quantities((d, P), data)[0]}["initial stiffness"]
        assert one.of((d, P)) / one.of(data) - 1.0 == pytest.approx(error, abs=1e-12)


def test_every_run_differs_by_one_thing():
    given = ["uncertainty.interface.strength=0.1", "uncertainty.material.young=0.001", "effects.contact=auto"]
    plan = planned("dcb-czm1", load_scene("dcb-czm1", given), "nurbs", given)
    runs = values(plan.codes["nurbs"], lambda job: job.solved)
    solved = [job.solved for job in plan.jobs]
    assert [scene.discretization.dofs for scene in runs["mesh"]] == [1956, 1505, 1157] and len(solved) == 3 + 2 * 2 + 2
    assert {scene.discretization.steps for scene in solved} == {"auto"}
    assert len({scene.interface.penalty for scene in solved}) == 1, "the contact stays as it is"
    assert all(isinstance(scene.effects.contact, bool) for scene in solved), "no effect may flip"
    assert [scene.interface.strength for scene in runs["interface.strength"]] == pytest.approx([3.6, 4.4])
    low, high = (scene.material.young for scene in runs["material.young"])
    assert high / low == pytest.approx(1.005 / 0.995), "a smaller step would be that of Newton's tolerance"
    assert all(runs[f"load.at={place}"][0].load.at == place for place in LOAD_PLACES)


def test_what_is_in_no_budget_is_said_and_an_input_that_the_scene_does_not_take_is_refused():
    plan = planned("dcb-czm1-linear", load_scene("dcb-czm1-linear"), "beam")
    said = [text.partition(":")[0] for text in plan.left_out]
    assert len(plan.jobs) == 1 and said == ["load introduction", "mesh", "inputs", "data"]
    assert planned("slb", load_scene("slb"), "nurbs").left_out[0].startswith("load introduction: ")
    closed = load_scene("dcb-czm1-linear", ["uncertainty.introduction=false"])
    assert list(planned("dcb-czm1-linear", closed, "nurbs").codes["nurbs"]) == ["mesh"]
    given = ["specimen.precrack=13.0", "uncertainty.specimen.precrack=0.1"]
    with pytest.raises(Refusal, match=r"uncertainty.specimen.precrack: .*specimen.precrack: must be .* times"):
        planned("dcb-czm1", load_scene("dcb-czm1", given), "nurbs", given)


@pytest.fixture
def lab(tmp_path, monkeypatch):
    """A curve of a tougher bond; runs are in this process."""
    run = solve(load_scene("dcb-czm1-linear", ["interface.toughness=0.103"]), "lefm")
    table = np.stack([run.opening, run.load], 1)
    np.savetxt(tmp_path / "lab.csv", table, delimiter=",", header="opening,load", comments="")

    def solved(plan, *_):
        return {job: Outcome(job, solve(job.solved, "lefm")) for job in plan}

    monkeypatch.setattr(validation.frame, "run", solved)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def command(*more: str) -> int:
    sets = [word for key in STATED for word in ("--set", f"uncertainty.{key}=0.02")]
    return main(["validate", "dcb-czm1-linear", "--with", "lab.csv", "--method", "lefm", *sets, "--out", "out", *more])


def test_it_writes_a_statement(lab, capsys):
    """Of one curve, which must be a file; nothing is written before."""
    for curves, said in (
        ((), "must name one"),
        (("lab.csv", "b=lab.csv"), "must name one"),
        (("no.csv",), "must be a file"),
    ):
        words = [word for curve in curves for word in ("--with", curve)]
        assert main(["validate", "dcb-czm1-linear", *words]) == REFUSED and said in capsys.readouterr().err
    assert command("--dry-run") == 0 and "9 of 9 runs to do" in capsys.readouterr().out and not (lab / "out").exists()
    assert command("--set", "uncertainty.data.load=0.01", "--at", "1.5,7") == 0
    printed = capsys.readouterr().out
    assert "peak load: S " in printed and "load at 7: left out" in printed and "u_val" in printed
    assert printed.startswith("the model against lab: peak load, initial stiffness")
    told = json.loads((lab / "out" / "validation.json").read_text())["statements"]
    assert told[0]["quantity"] == "peak load" and told[0]["E"] == pytest.approx(told[0]["S"] - told[0]["D"])
    assert {part["name"] for part in told[0]["parts"]} == {*STATED, "data.load"} and not told[0]["resolved"]
    assert len((lab / "out" / "validation.csv").read_text().splitlines()) == 1 + len(told) == 5
    assert "Validation against lab" in (lab / "out" / "report.html").read_text()


@pytest.mark.parametrize("scale", ["--opening-scale", "--load-scale"])
@pytest.mark.parametrize("factor", ["1000", "0.001"])
def test_data_in_other_units_leave_no_statement(scale, factor, lab, capsys):
    assert command(scale, factor) == FAILED
    printed = capsys.readouterr().out
    assert "no statement: the data open to " in printed and "units?" in printed and "told from zero" not in printed


def test_data_that_end_early_or_stand_on_a_plateau_are_in_no_other_units():
    """A peak anywhere on a plateau, and a largest load that is a small part of that of the simulation."""
    plateau = np.minimum(2.0 * D, 0.2)
    early, late = (D, plateau + 1e-9 * D * (D < 0.2)), (D, plateau + 1e-9 * D)
    assert other_units(early, late) == other_units(late, early) == ""
    assert other_units((D, 2.0 * D - 0.3 * D**2), (D[:20], 2.0 * D[:20])) == ""
    assert other_units(peaked(), (D[[0, -1]], np.array([0.0, 0.05]))) == "", "two points tell no stiffness"
