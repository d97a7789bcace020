"""The study of interface rules: its measure, its finding, and that it finds what the literature says."""

from dataclasses import replace

import numpy as np
import pytest

from verify.result import Result, Snapshot
from verify.scene.load import load_scene
from verify.studies import interface_rules
from verify.studies.interface_rules import DUCTILITIES, RULES, Study, Trial, excess_variation, finding, study


def profile(traction: np.ndarray) -> Snapshot:
    nothing = np.zeros_like(traction)
    grid = np.zeros((1, 2, 2))
    return Snapshot(0.4, 0.5, np.arange(traction.size) * 1.0, nothing, traction, nothing, grid, grid, grid)


def test_a_rise_and_a_dip_are_no_oscillation():
    x = np.linspace(0, 1, 200)
    smooth = np.where(x < 0.5, np.sin(2 * np.pi * x), 0.4 * np.sin(2 * np.pi * x))
    assert excess_variation(profile(4.0 * smooth), 4.0) == pytest.approx(0.0, abs=1e-12)
    assert excess_variation(profile(4.0 * smooth[100:]), 4.0) == pytest.approx(0.0, abs=1e-12), "from its peak on"
    saw = smooth + 0.1 * (-1.0) ** np.arange(200)
    assert 30.0 < excess_variation(profile(4.0 * saw), 4.0) < 40.0


@pytest.fixture(scope="module")
def found() -> Study:
    return study(rules=(("gauss", 2), ("lobatto", 4), ("lumped", None)), ductilities=(12.5, 50_000.0))


def test_lumping_cures_splines_on_a_stiff_interface_and_nothing_is_ill_on_a_soft_one(found):
    assert all(trial.status == "complete" for trial in found.trials) and len(found.trials) == 12
    assert found.scene.interface.ductility == 12.5, "that of the softest interface stands for all"
    assert all(trial.oscillation < 0.02 for trial in found.trials if trial.ductility == 12.5)
    stiff = {rule: found.of("nurbs", rule, n, 50_000.0) for rule, n in (("gauss", 2), ("lobatto", 4), ("lumped", None))}
    assert stiff["gauss"].oscillation > 1.0 and stiff["lobatto"].oscillation > 1.0
    assert stiff["lumped"].oscillation < 0.05 * stiff["gauss"].oscillation
    assert "with NURBS" in finding(found) and "lumping cures it" in finding(found).split(";")[0]


def test_a_rule_that_fails_is_told_and_costs_no_other(found, tmp_path):
    pytest.importorskip("matplotlib")
    from verify import report

    lost = Trial("nurbs", "gauss", 2, 50_000.0, float("nan"), None, "failed: ValueError: no mesh")
    trials = tuple(lost if (t.method, t.rule, t.ductility) == ("nurbs", "gauss", 50_000.0) else t for t in found.trials)
    report.write(report.Findings((), {}, replace(found, trials=trials)), tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text()
    assert "failed: ValueError: no mesh" in text and "NURBS, gauss, 2 points" in text
    assert text.count('id="quadrature-nurbs-t"') == 1 and 'href="#quadrature"' in text


def made_up() -> Study:
    """Rules by methods and ductilities, each with an oscillation of its own."""
    trials = []
    for i, method in enumerate(("nurbs", "lagrange")):
        for rule, points, size in (("gauss", 2, 0.5), ("lobatto", 4, 0.2), ("lumped", None, 0.049 + 0.002 * i)):
            for ductility, part in ((12.5, 0.01), (500.0, 1.0)):
                shown = profile(np.linspace(4.0, 0.0, 9) * (1.0 + size)) if ductility > 12.5 else None
                trials.append(Trial(method, rule, points, ductility, part * size, shown, "complete"))
    trials[0] = replace(trials[0], status="stopped: here")
    beams = tuple(
        (ductility, replace(profile(np.linspace(4.0, 0.0, 30)), opening=0.413)) for ductility in (12.5, 500.0)
    )
    return Study(load_scene("dcb-czm1"), tuple(trials), beams)


def test_lumping_cures_where_a_tenth_is_left_of_what_gauss_points_have():
    assert finding(made_up()) == (
        "Traction oscillation relative to the strength at ductility 500: with NURBS 50% with 2 Gauss points, 20% with "
        "4 Lobatto points, 5% lumped: lumping cures it; with Lagrange elements 50% with 2 Gauss points, 20% with 4 "
        "Lobatto points, 5% lumped: lumping does not cure it"
    )


def test_the_section_has_every_rule_and_draws_the_stiffest_interface(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("matplotlib")
    from figures import Drawn, legend

    from verify.pages.style import colour
    from verify.report.studies import interface_rules as page

    drawn, given = Drawn(monkeypatch, page), made_up()
    found = page.section(given, "quadrature")
    heads = ("NURBS, ductility 12.5", "NURBS, ductility 500", "Lagrange, ductility 12.5", "Lagrange, ductility 500")
    assert [one.title for one in found["table"].columns] == ["Rule", *heads] and found["finding"] == finding(given)
    cells = [[cell.text.replace("\u00a0", " ") for cell in row] for row in found["table"].cells()]
    assert [row[0] for row in cells] == ["gauss, 2 points", "lobatto, 4 points", "lumped"]
    assert cells[0][1:] == ["0.50 %", "50 %"] * 2 and cells[2][1:] == ["0.049 %", "4.9 %", "0.051 %", "5.1 %"]
    assert found["notes"] == ["NURBS, gauss, 2 points, ductility 12.5: stopped: here"]
    assert [one.svg for one in found["panels"]] == ["<svg>quadrature-nurbs</svg>", "<svg>quadrature-lagrange</svg>"]
    assert found["panels"][0].caption.replace("\u00a0", " ") == "NURBS, ductility 500, opening 0.413 mm."
    start = given.scene.specimen.precrack
    for _, figure in drawn:
        (axes,) = figure.axes
        assert legend(figure) == ["beam", "gauss, 2 points", "lobatto, 4 points", "lumped"]
        assert [max(line.get_ydata()) for line in axes.lines] == pytest.approx([1.0, 1.5, 1.2, 1.05], rel=2e-3)
        inks = [colour(name) for name in ("muted", "bad", "lagrange", "nurbs")]
        assert [line.get_color() for line in axes.lines] == inks and axes.get_xlim() == (start, start + 2.5)
        assert axes.get_ylabel() == "traction / strength" and "mm" in axes.get_xlabel()


def test_rules_that_are_drawn_or_spoken_of_are_among_those_that_are_tried() -> None:
    """Gauss and Lobatto rules of as many points, 2, 4 and 8, and lumping, on ever stiffer interfaces."""
    pytest.importorskip("matplotlib")
    from verify.report.studies.interface_rules import DRAWN

    assert {(rule, points) for rule, points, _ in DRAWN} <= set(RULES)
    assert {("gauss", 2), ("lobatto", 4), ("lumped", None)} <= set(RULES), "the finding is theirs"
    points = {rule: [n for name, n in RULES if name == rule] for rule in ("gauss", "lobatto", "lumped")}
    assert points == {"gauss": [2, 4, 8], "lobatto": [2, 4, 8], "lumped": [None]}
    assert list(DUCTILITIES) == sorted(DUCTILITIES) and DUCTILITIES[0] == load_scene("dcb-czm1").interface.ductility


def test_a_solver_that_raises_is_a_finding(monkeypatch):
    def lost(scene, method):
        raise ArithmeticError("no mesh")

    monkeypatch.setattr(interface_rules, "solve", lost)
    said = interface_rules._trial("nurbs", "gauss", 2, 50.0, ())
    assert said.status == "failed: ArithmeticError: no mesh" and said.profile is None and np.isnan(said.oscillation)
    assert (said.method, said.rule, said.points, said.ductility) == ("nurbs", "gauss", 2, 50.0)


def test_without_a_field_there_is_no_oscillation(monkeypatch):
    steps = {"opening": np.zeros(1), "load": np.zeros(1)}
    monkeypatch.setattr(interface_rules, "solve", lambda scene, method: Result(method, steps, status="stopped: here"))
    said = interface_rules._trial("nurbs", "lumped", None, 50.0, ())
    assert np.isnan(said.oscillation) and said.profile is None and said.status == "stopped: here"
