"""A law that one solver has and others lack: who solves with it, who refuses it in which words, how it is judged."""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import pytest
from made_up_laws import MADE_UP, BridgedLaw

from iga.bases.names import BASES
from iga.laws.laws import LAWS
from verify.checks.between_codes import cross_checks
from verify.checks.identities import run_checks
from verify.checks.mechanics.j_integral import J_OF_ANY_LAW, J_OF_LAW
from verify.cli import main
from verify.methods.names import METHODS, Unsuitable
from verify.methods.solve import prepare, require, solve
from verify.pages.text import inputs
from verify.result import Result
from verify.scene.laws import known
from verify.scene.load import load_scene
from verify.scene.parse import SceneError, parse_scene
from verify.scene.schema import Scene
from verify.support.refusal import one_of
from verify.verdict import Check

NAME = "bridged"
LACKING = tuple(name for name, method in METHODS.items() if name not in BASES and not method.is_limit)


@dataclass(frozen=True)
class TooTough(BridgedLaw):
    """A law that takes 2 % more than the toughness that it is given, consistently."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "toughness", 1.02 * self.toughness)


@pytest.fixture(autouse=True)
def table(monkeypatch):
    """The laws of the tests in the table of the isogeometric code, as a class that is written there."""
    for name, law in MADE_UP.items():
        monkeypatch.setitem(LAWS, name, law)


def scene_with(law: str, *overrides: str) -> Scene:
    sets = ("discretization.dofs=1200", "discretization.steps=80", "load.opening=2.0", f"interface.law={law}")
    return load_scene("dcb-czm1", (*sets, *overrides))


def judged(scene: Scene, result: Result) -> dict[str, Check]:
    return {check.name: check for check in run_checks(scene, result)}


def test_a_scene_takes_every_law_that_a_solver_has():
    scene = scene_with(NAME)
    assert scene.interface.law == NAME and parse_scene(scene.model_dump()) == scene
    assert set(known()) >= {*LAWS}
    for law in ("no-such-law", "3"):
        with pytest.raises(SceneError) as caught:
            scene_with(law)
        assert all(f'"{name}"' in caught.value.sentences[0] for name in LAWS)


@pytest.mark.parametrize("specimen", ["dcb-czm1", "peel-120"])
def test_the_isogeometric_problem_has_the_law_of_the_scene(specimen):
    scene = load_scene(specimen, [f"interface.law={NAME}", "effects.contact=false"])
    law = prepare(scene, "nurbs").problem[1].law
    assert isinstance(law, BridgedLaw) and law.penalty == scene.interface.penalty and not law.contact


@pytest.mark.parametrize("method", METHODS)
def test_a_method_has_a_law_or_refuses_it_with_who_has_it(method):
    assert (NAME in METHODS[method].laws()) == (method not in LACKING)
    if method not in LACKING:
        require(prepare(scene_with(NAME), method))
        return
    with pytest.raises(Unsuitable) as caught:
        require(prepare(scene_with(NAME), method))
    *head, last = [name for name in METHODS if name not in LACKING]
    has, able = one_of(METHODS[method].laws()), f"{', '.join(head)} and {last}"
    assert str(caught.value) == f"interface.law: must be {has} for {method}, got '{NAME}'; {able} have it"


@pytest.mark.parametrize(
    "words", [*(["solve", "--method", method] for method in LACKING), ["export", "--format", "abaqus"]]
)
def test_the_command_line_says_so_and_exits_with_two(words, tmp_path, capsys):
    command, option, who = words
    line = [command, "dcb-czm1", option, who, "--set", f"interface.law={NAME}", "--out", str(tmp_path / "run")]
    assert main(line) == 2 and not (tmp_path / "run").exists()
    said = capsys.readouterr().err
    assert "interface.law: must be " in said and f" for {'an export' if command == 'export' else who}" in said


def test_a_plug_in_has_the_laws_that_it_names(tmp_path, monkeypatch):
    place = tmp_path / "site"
    (place / "fakelaws-0.1.dist-info").mkdir(parents=True)
    (place / "fakelaws-0.1.dist-info" / "METADATA").write_text("Metadata-Version: 2.1\nName: fakelaws\nVersion: 0.1\n")
    entries = "[debond.methods]\nplain = fakelaws:plain\nable = fakelaws:able\n"
    (place / "fakelaws-0.1.dist-info" / "entry_points.txt").write_text(entries)
    module = "def plain(scene, on_step): ...\ndef able(scene, on_step): ...\nable.laws = ('bilinear', 'bridged')\n"
    (place / "fakelaws.py").write_text(module)
    monkeypatch.syspath_prepend(str(place))
    monkeypatch.delitem(sys.modules, "fakelaws", raising=False)
    require(prepare(scene_with(NAME), "able"))
    require(prepare(scene_with("bilinear"), "plain"))
    with pytest.raises(Unsuitable, match='must be "bilinear" for plain'):
        require(prepare(scene_with(NAME), "plain"))
    with pytest.raises(Unsuitable, match='must be "bilinear" or "bridged" for able'):
        require(prepare(scene_with("a-parabola"), "able"))


@pytest.fixture(scope="module")
def runs():
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(LAWS, NAME, BridgedLaw)
        return {method: solve(scene_with(NAME), method) for method in ("tspline", "nurbs", "lefm")}


@pytest.mark.parametrize("method", ["tspline", "nurbs"])
def test_a_run_with_a_law_that_no_check_knows_is_judged_by_what_holds_of_any(runs, method):
    found = judged(scene_with(NAME), runs[method])
    print({name: f"{check.value:.1e}" for name, check in found.items()})
    assert {"completed", "j-integral", "energy-ledger", "interface-force", "dissipation"} <= set(found)
    assert all(check.passed for check in found.values())
    assert found["j-integral"].value > 1e-6, "nothing was held against it"
    assert found["j-integral"].meaning == J_OF_ANY_LAW
    assert judged(scene_with("bilinear"), runs[method])["j-integral"].meaning == J_OF_LAW


def test_a_wrong_column_fails_its_check_as_ever(runs):
    run, scene = runs["nurbs"], scene_with(NAME)
    columns = {"load": "j-integral", "stored_energy": "energy-ledger", "dissipated_energy": "dissipation"}
    for factor, (column, check) in product((1.05, np.nan), columns.items()):
        steps = {**run.steps, column: factor * run.steps[column]}
        assert not judged(scene, replace(run, steps=steps))[check].passed, (factor, column)
    # judged as a bilinear law it would fail: the judge does not take one law for another
    assert not judged(scene_with("bilinear"), runs["tspline"])["j-integral"].passed
    assert cross_checks(scene, runs) == (), "codes without the law are held against nothing"


def test_a_law_with_another_toughness_than_it_was_given_is_found_out(monkeypatch):
    monkeypatch.setitem(LAWS, NAME, TooTough)
    scene = scene_with(NAME)
    found = judged(scene, solve(scene, "tspline"))
    assert found["energy-ledger"].passed
    assert found["j-integral"].value == pytest.approx(0.02, abs=0.004) and not found["j-integral"].passed


def test_the_inputs_tell_no_opening_that_only_the_bilinear_law_has():
    plain, other = (" ".join(name for _, name, _ in inputs(scene_with(law))) for law in ("bilinear", NAME))
    assert "full opening g_u" in plain and "ductility" in other and "g_u" not in other
