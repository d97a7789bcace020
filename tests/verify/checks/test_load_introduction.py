"""Where the load acts: what a corner changes, by an estimate, by runs, and by two codes; what is said of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from verify.checks import load_introduction
from verify.checks.between_codes import cross_checks
from verify.checks.foreign_curves import joined
from verify.checks.identities import run_checks
from verify.checks.orders import ARMS, ARMS_SECOND, BEAM_RUN, remarks
from verify.export.mesh import scene_mesh
from verify.export.numbers import notes
from verify.methods.dolfinx import dolfinx_installed
from verify.methods.solve import solve
from verify.result import Result
from verify.scene.load import load_scene
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene
from verify.support.refusal import Refusal
from verify.verdict import SceneReport


def stocky(*overrides: str) -> Scene:
    """Arms four times as long as thick, and a bond that turns their ends by 15 degrees."""
    raw = {
        "specimen": {"kind": "dcb", "length": 12.0, "arm_thickness": 1.0, "precrack": 4.0, "plane": "strain"},
        "material": {"young": 1000.0, "poisson": 0.02},
        "interface": {"strength": 10.0, "toughness": 1.2, "ductility": 35.0},
        "load": {"opening": 1.6},
        "discretization": {"dofs": 1000, "steps": 40},
        "dolfinx": {"degree": 4, "elements": 60},
    }
    return parse_scene(raw, overrides)


@pytest.mark.slow
@pytest.mark.parametrize("kinematics", ["finite", "linear"])
def test_a_corner_gives_way_and_comes_closer_to_the_crack(kinematics):
    """The estimate is of the size of what two runs say; without large displacements the lever stays."""
    scene = stocky(f"effects.kinematics={kinematics}")
    found, about = load_introduction.measured(scene), load_introduction.estimate(scene)
    assert about.stiffness / 2.5 > found.stiffness > 2.5 * about.stiffness and about.stiffness < -0.003
    if kinematics == "finite":
        assert about.peak / 2 < found.peak < 2 * about.peak and found.peak > 0.02
    else:
        assert abs(found.peak) < 0.01 and about.peak == 0.0


def test_it_is_said_where_it_matters_and_to_whoever_compares():
    slender = load_scene("dcb-czm1")
    assert load_introduction.remarks(slender) == () and not load_introduction.matters(slender)
    (said,) = load_introduction.remarks(stocky("effects.kinematics=linear"))
    assert load_introduction.estimate(stocky()).stiffness < -0.003 and "(two runs of this scene)" in said
    assert any("peak load by +0.18 % (an estimate)" in note for note in notes(slender))
    report = SceneReport(slender, (), ())
    assert joined(report, [], None).remarks == ()
    assert (
        load_introduction.sentence(stocky("load.at=node")) == ""
        and load_introduction.remarks(stocky("load.at=node")) == ()
    )
    assert "what is not known" in load_introduction.sentence(load_scene("peel-soft")), "a strip that turns upright"


@pytest.mark.slow
@pytest.mark.parametrize("at", ["node", "hinge"])
def test_both_codes_pull_at_the_same_point(at):
    """Balances hold with the lever of that point; the J-integral, which needs an even load, is not judged."""
    if not dolfinx_installed():
        pytest.skip("DOLFINx is not installed")
    scene = stocky(f"load.at={at}")
    runs = {method: solve(scene, method) for method in ("nurbs", "dolfinx")}
    for run in runs.values():
        found = {check.name: check for check in run_checks(scene, run)}
        assert "j-integral" not in found and found["moment-balance"].passed and found["energy-ledger"].passed
    found = {check.name: check for check in cross_checks(scene, runs)}
    assert abs(found["stiffness"].value) < 0.002 and found["curve"].value < 0.005
    even = solve(stocky(), "nurbs")
    change = runs["nurbs"].steps["load_slope"][0] / even.steps["load_slope"][0] - 1.0
    assert (change < -0.004) if at == "node" else abs(change) < 0.001


def test_a_beam_has_no_corner():
    run = Result("beam", {"opening": np.array([0.0, 1.0]), "load": np.array([0.0, 1.0])})
    runs = {**dict.fromkeys((BEAM_RUN, ARMS, ARMS_SECOND), run), "nurbs": replace(run, method="nurbs")}
    for at, judged in (("face", True), ("hinge", True), ("node", False)):
        scene = stocky(f"load.at={at}", "interface.strength=5.0")
        assert ("beam-curve" in {check.name for check in cross_checks(scene, runs)}) == judged
        assert any("held against no code" in text for text in remarks(scene, runs)) != judged
    assert "beam-curve" in {c.name for c in cross_checks(load_scene("dcb-czm1", ["load.at=node"]), runs)}


def test_an_export_pulls_where_the_scene_says():
    corners = {"upper": (0.0, 1.0), "lower": (0.0, -1.0)}
    for at, part in (("node", 1.0), ("hinge", 0.5)):
        mesh = scene_mesh(stocky(f"load.at={at}", "dolfinx.degree=2"))
        for face, place in zip(mesh.loaded, corners.values(), strict=True):
            assert face.weight_n.tolist() == [1.0]
            assert mesh.X_nI[face.node_n[0]] == pytest.approx((0.0, part * place[1]))
    assert any("the corner away from the bond" in note for note in notes(stocky("load.at=node")))
    with pytest.raises(Refusal, match="degree: must be even for a load in the middle of a face of 1 element, got 1"):
        scene_mesh(stocky("load.at=hinge", "dolfinx.degree=1", "dolfinx.layers=1"))
    assert len(scene_mesh(stocky("dolfinx.degree=2", "dolfinx.layers=1")).loaded[0].node_n) == 3
