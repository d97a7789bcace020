"""Published values: how scenes carry them, how runs are held against them, where the page shows them."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from verify.checks.between_codes import cross_checks, published_checks, published_load, published_names
from verify.checks.identities import run_checks
from verify.checks.mechanics.columns import law_of
from verify.checks.mechanics.j_integral import J_TOLERANCE
from verify.methods.dolfinx import dolfinx_installed
from verify.methods.solve import solve
from verify.result import Result
from verify.scene.load import load_scene, packaged_scenes, verified_scenes
from verify.scene.parse import SceneError
from verify.scene.schema import Scene

PEAK = 'quantity = "peak", tolerance = 0.03, source = "them"'
AT = 'quantity = "load_at", tolerance = 0.03, source = "them"'

#: what stands in published -> the sentence that must come
BROKEN = {
    f"[{{{PEAK}, value = -1.0}}]": "published[0].value: must be > 0, got -1",
    f"[{{{PEAK}, value = [0.0, 1.0]}}]": "published[0].value[0]: must be > 0, got 0",
    f"[{{{PEAK}, value = [2.0, 1.0]}}]": "published[0].value: must be the lowest before the highest, got [2.0, 1.0]",
    f"[{{{PEAK}, value = [1.0]}}]": (
        "published[0].value: must be a number, or a list of two, the lowest and the highest, got [1.0]"
    ),
    f'[{{{PEAK}, value = "8"}}]': (
        "published[0].value: must be a number, or a list of two, the lowest and the highest, got '8'"
    ),
    f"[{{{PEAK}}}]": "published[0].value: is missing, must be a number, or a list of two, the lowest and the highest",
    f"[{{{PEAK}, value = 1.0, opening = 2.0}}]": (
        "published[0].opening: must be left out for a peak, wherever it is, got 2"
    ),
    f"[{{{AT}, value = 1.0}}]": "published[0].opening: is missing, must be a number > 0",
    f"[{{{PEAK}, value = 1.0}}, {{{AT}, value = 1.0, opening = 3.1}}]": (
        "published[1].opening: must be <= 3, the largest load.opening, got 3.1"
    ),
    f"[{{{AT}, value = 1.0, opening = 1.0, leg = 2}}]": (
        "published[0].leg: must be <= 1, the number of legs of load.opening, got 2"
    ),
    '[{quantity = "force", value = 1.0, tolerance = 0.03, source = "them"}]': (
        'published[0].quantity: must be "peak" or "load_at", got \'force\''
    ),
    '[{quantity = "peak", value = 1.0, tolerance = 0.03, source = " "}]': (
        "published[0].source: must be a text that says where the value is written, got ' '"
    ),
    "3": "published: must be a list of tables, each under [[published]], got 3",
}


def benchmarks() -> list[str]:
    return [name for name in packaged_scenes() if load_scene(name).published]


def with_values(*tables: str) -> Scene:
    return load_scene("dcb-czm1", [f"published=[{', '.join(tables)}]"])


def drawn(method: str, peak: float = 2.0) -> Result:
    """A load that rises to its peak at opening 1 and falls to half of it at opening 3."""
    opening = np.linspace(0.0, 3.0, 31)
    load = peak * np.where(opening <= 1.0, opening, 1.25 - opening / 4)
    return Result(method, {"opening": opening, "load": load})


@pytest.mark.parametrize("value", BROKEN)
def test_a_broken_table_is_refused_with_key_range_and_value(value):
    with pytest.raises(SceneError) as caught:
        load_scene("dcb-czm1", [f"published={value}"])
    assert caught.value.sentences == (BROKEN[value],)


def test_a_run_is_held_against_every_value():
    scene = with_values(
        f"{{{PEAK}, value = 2.0}}",
        f"{{{PEAK}, value = [1.5, 1.9], kind = 'analytical'}}",
        f"{{{AT.replace('0.03', '0.01')}, value = 1.6, opening = 2.0}}",
        f"{{{AT}, value = [0.9, 1.1], opening = 3.0}}",
    )
    assert Scene.model_validate(scene.model_dump()) == scene
    checks = {check.name: check for check in published_checks(scene, {"nurbs": drawn("nurbs")})}
    coarse = published_checks(scene, {"lagrange": drawn("lagrange")})
    assert {check.tolerance for check in (*checks.values(), *coarse)} == {0.03, 0.01, 0.02}, "of value or mesh"
    assert {name: check.value for name, check in checks.items()} == pytest.approx(
        {
            "published-peak": 0.0,
            "published-peak-2": 2.0 / 1.9 - 1,  # above the range
            "published-load-2": 1.5 / 1.6 - 1,
            "published-load-3": 0.0,  # within it
        }
    )
    assert [check.passed for check in checks.values()] == [True, False, False, True]
    assert [check.kind for check in checks.values()] == ["cross-code", "analytical", "cross-code", "cross-code"]
    assert all(check.subject == "nurbs" and check.meaning.endswith(": them.") for check in checks.values())
    assert published_names(scene) == tuple(checks)


def test_a_mesh_that_does_not_resolve_the_zone_gives_no_verdict():
    """Fewer elements in the zone explain more, as much as they explain of J, and short ones nothing."""
    cases = (5000, 1.15, "unresolved"), (12000, 1.15, "unresolved"), (12000, 1.5, "broken"), (40000, 1.15, "broken")
    for dofs, off, state in cases:
        overrides = [f"published=[{{{PEAK}, value = 2.0}}]", f"discretization.dofs={dofs}"]
        scene = load_scene("krueger-dcb", overrides)
        (check,) = published_checks(scene, {"lagrange": drawn("lagrange", 2.0 * off)})
        assert check.state == state, (dofs, off)


def test_a_load_between_steps_is_on_the_arc_of_the_path():
    """A parabola through steps with their slopes: in the middle of one linear interpolation is 1/64 off."""
    x = np.linspace(0.0, 2.0, 9)
    known = with_values(f"{{{AT}, value = 1.0, opening = 0.625}}").published[0]
    straight = Result("nurbs", {"opening": x, "load": 1 - (x - 1) ** 2})
    exact = 1 - 0.375**2
    assert published_load(known, straight) == pytest.approx(exact - 1 / 64)
    curved = replace(straight, steps=straight.steps | {"load_slope": 2 * (1 - x), "heading": np.ones(9)})
    assert published_load(known, curved) == pytest.approx(exact, abs=2e-3)


def test_a_run_that_stops_before_the_opening_fails():
    scene = with_values(f"{{{AT}, value = 1.6, opening = 2.0}}")
    whole = drawn("nurbs")
    early = replace(whole, steps={name: column[:15] for name, column in whole.steps.items()})
    (check,) = published_checks(scene, {"nurbs": early})
    assert np.isnan(check.value) and not check.passed


def test_all_codes_are_judged_but_fracture_mechanics_and_coarse_meshes_are_not():
    scene = with_values(f"{{{PEAK}, value = 2.0}}")
    names = ("tspline", "nurbs", "lagrange", "dolfinx", "dolfinx-p3", "beam", "lefm", "nurbs-978")
    checks = cross_checks(scene, {name: drawn(name) for name in names})
    judged = {check.subject for check in checks if check.name == "published-peak"}
    assert judged == set(names) - {"lefm", "nurbs-978"}


def test_the_page_shows_published_values_with_their_source(tmp_path):
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    from verify import report
    from verify.verdict import Run, SceneReport

    scene = load_scene("compdam-dcb")
    runs = {"beam": solve(scene, "lefm")}  # what is shown does not depend on who computed it
    found = tuple(Run(name, name, replace(result, method=name)) for name, result in runs.items())
    report.write(
        report.Findings((SceneReport(scene, found, published_checks(scene, runs)),), {}), tmp_path / "report.html"
    )
    text = (tmp_path / "report.html").read_text()
    table = re.search(r'<table class="published">.*?</table>', text, re.DOTALL)[0]
    plain = re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", table))
    assert "peak load CompDam, github.com/nasa/CompDam_DGD" in plain and "load at 4.5 mm" in plain
    load = published_load(scene.published[0], runs["beam"])
    assert f"8 N 3.0 % {load:.3f} N \u2212{100 * (1 - load / 8):.2f} %" in plain.replace("\u00a0", " ")
    assert text.count("finalLoadTol") == 2  # there and with its check


def test_benchmarks_are_run_by_name_only():
    assert len(benchmarks()) == 15
    assert not set(benchmarks()) & set(verified_scenes())


@pytest.mark.parametrize(("name", "stiffness"), [("compdam-dcb", 2e5), ("tijs-dcb", 1e6)])
def test_ductility_stands_for_the_initial_stiffness_of_the_source(name, stiffness):
    scene = load_scene(name)
    assert law_of(scene).stiffness == pytest.approx(stiffness, rel=1e-4)
    assert scene.interface.penalty == stiffness


def test_compdam_published_the_corrected_beam_theory():
    scene = load_scene("compdam-dcb")
    limit = solve(scene, "lefm")
    peak, last = (published_load(known, limit) for known in scene.published)
    assert (f"{peak:.1f}", f"{last:.2f}") == ("8.0", "4.38"), "to every digit that was published"
    assert peak == limit.load.max(), "the corner where the crack starts is a step"


@pytest.mark.slow
@pytest.mark.parametrize("method", ["tspline", "nurbs", "dolfinx", "beam"])
@pytest.mark.parametrize("name", benchmarks())
def test_whole_benchmarks(name, method):
    if method == "dolfinx" and not dolfinx_installed():
        pytest.skip("DOLFINx is not installed")
    scene = load_scene(name)
    result = solve(scene, method)
    checks = (*run_checks(scene, result), *published_checks(scene, {method: result}))
    # While the process zone forms, J measures meshes that are four times coarser on the other side of the crack tip.
    assert [check for check in checks if not check.passed and check.name != "j-integral"] == []
    if not scene.interface.slides:
        assert np.mean(grown_J(scene, result)) == pytest.approx(scene.interface.toughness, rel=J_TOLERANCE)


def grown_J(scene: Scene, result: Result) -> np.ndarray:
    """The J-integral (n,) at the steps at which the tip of the precrack is fully open: G_Ic, whatever the law."""
    steps = result.steps
    slopes = np.abs(steps["face_slope_top"]) + np.abs(steps["face_slope_bottom"])
    J = steps["load"] * slopes / scene.specimen.width - steps["face_energy"]
    return J[steps["tip_opening"] >= law_of(scene).g_open]


def test_a_load_on_a_leg_of_the_programme():
    """On the way down and back it is not that of the envelope; an opening off the leg is refused."""
    values = [f"{{{AT}, value = 1.0, opening = 0.8{leg}}}" for leg in ("", ", leg = 1", ", leg = 2", ", leg = 3")]
    programme = "load.opening=[1.5, 0.2, 3.0]"
    scene = load_scene("dcb-czm1", [programme, f"published=[{', '.join(values)}]"])
    names = ["published-load-0.8", *(f"published-load-0.8-leg-{leg}" for leg in (1, 2, 3))]
    assert list(published_names(scene)) == names
    opening = np.array([0.0, 1.0, 1.5, 0.2, 1.5, 3.0])
    run = Result("nurbs", {"opening": opening, "load": np.array([0.0, 2.0, 1.5, 0.3, 1.4, 0.5])})
    found = {check.name: 1.0 + check.value for check in published_checks(scene, {"nurbs": run})}
    assert [found[name] for name in names] == pytest.approx([1.6, 1.6, 1.5 - 1.2 * 7 / 13, 0.3 + 1.1 * 6 / 13])
    with pytest.raises(SceneError, match=re.escape("published[0].opening: must be >= 0.2 and <= 1.5, leg 2 of load")):
        load_scene("dcb-czm1", [programme, f"published=[{{{AT}, value = 1.0, opening = 2.0, leg = 2}}]"])
