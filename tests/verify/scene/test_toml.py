"""Scenes that are written to a file are those that are read from it."""

import pytest

from verify import verification
from verify.cli import main
from verify.command_line.scenes.new import from_scene
from verify.scene.load import load_scene, packaged_scenes
from verify.scene.toml import keep_scene
from verify.studies import one_scene


@pytest.mark.parametrize("name", packaged_scenes())
def test_a_scene_comes_back_as_it_was(name, tmp_path):
    scene = load_scene(name, ['units="N, µm; \\"GPa\\""'])
    keep_scene(scene, tmp_path / "a.toml")
    assert load_scene(tmp_path / "a.toml") == scene
    (tmp_path / "b.toml").write_text(from_scene(scene), encoding="utf-8")
    assert load_scene(tmp_path / "b.toml") == scene


def test_what_is_published_of_a_problem_is_not_of_another():
    known = load_scene("adcb-czmtestkit-a").published
    assert (
        known and load_scene("adcb-czmtestkit-a", ["discretization.dofs=900", "effects.search=true"]).published == known
    )
    assert load_scene("adcb-czmtestkit-a", ["interface.toughness=0.5"]).published == ()
    assert load_scene("adcb-czmtestkit-a", ["load.opening=3.0"]).published == ()


def test_a_scene_with_settings_is_verified_and_travels(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    planned = one_scene.planned
    beam_alone = lambda *given, **how: [job for job in planned(*given, **how) if job.method == "beam"]  # noqa: E731
    monkeypatch.setattr(verification, "planned", beam_alone)
    short = ["--set", "load.opening=0.4", "--set", "discretization.dofs=400", "--set", "dolfinx.elements=28"]
    code = main(["verify", "dcb-czm1-linear", *short, "--no-ladder", "--out", "report"])
    assert code in (0, 1)
    scene = load_scene("report/dcb-czm1-linear/scene.toml")
    assert scene == load_scene("dcb-czm1-linear", short[1::2])
    assert "debond solve report/dcb-czm1-linear/scene.toml" in (tmp_path / "report" / "verdict.json").read_text()
    capsys.readouterr()
    own = ["verify", "report/dcb-czm1-linear/scene.toml", "--set", "load.opening=0.3", "--out", "report"]
    assert main(own) == 2 and "--out: must be another folder" in capsys.readouterr().err
    assert main(["new", "--from", "report/dcb-czm1-linear/scene.toml", "--set", "name=mine"]) == 0
    text = capsys.readouterr().out
    (tmp_path / "mine.toml").write_text(text)
    assert load_scene("mine.toml").load.opening == (0.4,) and "# Young's modulus [MPa]" in text


def test_new_needs_a_kind_or_a_scene(capsys):
    assert main(["new"]) == 2 and main(["new", "dcb", "--from", "dcb-czm1"]) == 2
    assert main(["new", "dcb", "--set", "name=a"]) == 2
    assert "--from SCENE" in capsys.readouterr().err
