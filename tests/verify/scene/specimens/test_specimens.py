"""What every specimen has to do, whichever there are: its example is read, drawn and solved, and its checks hold."""

from __future__ import annotations

import tomllib

import pytest

from verify.checks.identities import run_checks
from verify.command_line.scenes.listing import sketch
from verify.command_line.scenes.new import new_scene
from verify.methods.solve import prepare, solve
from verify.pages.text import inputs, sentence
from verify.scene.parse import parse_scene
from verify.scene.schema import Scene
from verify.scene.specimens import SPECIMENS

kinds = pytest.mark.parametrize("kind", SPECIMENS)


def example(kind: str, *overrides: str) -> Scene:
    return parse_scene(tomllib.loads(new_scene(kind)), overrides)


@kinds
def test_its_bodies_are_those_of_its_keys(kind):
    body = example(kind).specimen
    if body.slides:
        assert body.lengths[0] == body.lengths[1] == body.loaded_at + body.extent
        assert body.thicknesses == body.arm_thickness and not body.symmetric
        assert body.bonded == (body.loaded_at + body.precrack, body.lengths[0])
        assert len(body.supports) in (0, 2)
        return
    assert body.lengths == tuple(getattr(body, key) for key in body.length_keys)
    assert body.thicknesses == tuple(getattr(body, key) for key in body.thickness_keys)
    tip, end = body.bonded
    assert tip == getattr(body, body.tip_key) and 0.0 <= min(tip, end) < max(tip, end) <= min(body.lengths)
    assert body.free_length + abs(end - tip) == pytest.approx(body.extent) == body.lengths[0]
    assert len(body.loads) + len(body.clamps) == 2 and set(body.materials) <= set(Scene.model_fields)


@kinds
def test_it_is_drawn_and_described(kind):
    scene = example(kind)
    lines = sketch(scene, 80)
    assert all(f"{thickness:.4g} thick" in "\n".join(lines) for thickness in scene.specimen.thicknesses)
    pytest.importorskip("matplotlib")
    from verify.report.figures import drawing

    zone = (scene.specimen.free_length, 0.5 * (scene.specimen.free_length + scene.specimen.extent), 1.0)
    assert drawing.specimen(scene, "key", zone).caption.startswith("The undeformed specimen")
    assert "{" not in sentence(scene) and {row[0] for row in inputs(scene)} >= {"specimen", *scene.specimen.materials}


#: Without --slow each kind is solved by one method, in turn.
TURNS = ("tspline", "nurbs", "lagrange", "nurbs")


@pytest.mark.parametrize(
    ("kind", "method"),
    [
        pytest.param(kind, method, marks=() if method == TURNS[i % len(TURNS)] else pytest.mark.slow)
        for i, kind in enumerate(SPECIMENS)
        for method in TURNS[:3]
    ],
)
def test_its_example_is_solved_and_the_checks_hold(kind, method):
    """Nothing is broken; a mesh as coarse as that may leave a check unresolved."""
    opening = 0.2 * max(example(kind).load.opening)
    scene = example(kind, f"load.opening={opening}", "discretization.steps=6", "discretization.dofs=800")
    result = solve(scene, method)
    assert result.complete and result.opening[-1] == pytest.approx(opening)
    checks = run_checks(scene, result)
    of_a_sliding_bond = {"j-loads", "arm-balance"} | ({"supports"} if scene.specimen.supports else set())
    wanted = of_a_sliding_bond if scene.specimen.slides else {"interface-force", "moment-balance"}
    assert wanted | {"energy-ledger"} <= {check.name for check in checks}
    assert [check for check in checks if check.state == "broken"] == []


@kinds
def test_the_meshes_are_those_of_its_bodies(kind):
    scene = example(kind)
    solver, problem = prepare(scene, "nurbs").problem
    for mesh, length, thickness in zip(
        solver.build(problem).meshes, scene.specimen.lengths, scene.specimen.thicknesses, strict=True
    ):
        assert tuple(mesh.P_AI.max(0) - mesh.P_AI.min(0)) == pytest.approx((length, thickness))
