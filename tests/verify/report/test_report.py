"""The report, on made-up runs whose shape is that of real ones."""

from __future__ import annotations

import re
from dataclasses import replace
from html.parser import HTMLParser
from math import nan
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from made_up_costs import SCENE, a_row, against  # noqa: E402
from made_up_runs import ENVIRONMENT, made_up, scene_report  # noqa: E402

from verify import report  # noqa: E402
from verify.checks.mechanics.columns import law_of  # noqa: E402
from verify.curves.curve import curve_error  # noqa: E402
from verify.methods.dolfinx import DOLFINX_MISSING, DOLFINX_WAYS  # noqa: E402
from verify.pages.text import inputs, number, percent, quantity, seconds  # noqa: E402
from verify.report.figures.agreement import path  # noqa: E402
from verify.report.tally import EVIDENCE  # noqa: E402
from verify.result import CURVE_COLUMNS, Result  # noqa: E402
from verify.scene.load import load_scene  # noqa: E402
from verify.studies.cost.price import Price  # noqa: E402
from verify.verdict import Check, SceneReport  # noqa: E402


def changed(given: SceneReport, method: str, **changes: object) -> SceneReport:
    """The report with one run's fields replaced."""
    runs = tuple(replace(run, **changes) if run.method == method else run for run in given.runs)
    return replace(given, runs=runs)


def stopped(result: Result, rows: int) -> Result:
    steps = {name: values[:rows] for name, values in result.steps.items()}
    return replace(result, steps=steps, status="stopped: no convergence; ask for more steps", snapshots=())


class Page(HTMLParser):
    """Collects what the tests ask about; complains about tags that do not match."""

    VOID = {"meta", "link", "img", "br", "hr", "input", "use", "path", "line", "rect", "image"}

    def __init__(self, text: str) -> None:
        super().__init__()
        self.addresses: list[str] = []
        self.ids: list[str] = []
        self.tags: list[str] = []
        self.open: list[str] = []
        self.words: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = dict(attrs)
        self.tags.append(tag)
        self.ids += [found["id"]] if "id" in found else []
        self.addresses += [v for k, v in attrs if k in ("href", "src", "xlink:href", "srcset", "data", "action") and v]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag not in self.VOID:
            assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words.append(data)

    @property
    def text(self) -> str:
        return re.sub(r"[ \n]+", " ", " ".join(self.words))


def page(folder: Path, *reports: SceneReport) -> tuple[str, Page]:
    report.write(report.Findings(reports, ENVIRONMENT), folder / "report.html")
    text = (folder / "report.html").read_text(encoding="utf-8")
    return text, Page(text)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Page]:
    """Two scenes with everything there; tests that change nothing share it."""
    return page(tmp_path_factory.mktemp("report"), scene_report(), scene_report("dcb-czm2"))


def test_asks_nothing_of_the_network(whole: tuple[str, Page]) -> None:
    text, parsed = whole
    assert all(a.startswith(("#", "data:image/webp;base64,", "./")) for a in parsed.addresses)
    assert not {"link", "iframe", "object", "embed"} & set(parsed.tags)
    folds, stepper = re.findall("<script>(.*?)</script>", text, re.DOTALL)
    assert parsed.tags.count("script") == 2 and "details" in folds and "stepper" in stepper
    assert not re.search(r"fetch\(|XMLHttpRequest|WebSocket|import\(|sendBeacon", text)
    assert not re.search(r"url\((?!#)|@import|https?://(?!www\.w3\.org/)", text)


def test_is_small_enough_and_every_tag_is_closed(whole: tuple[str, Page]) -> None:
    text, parsed = whole
    assert not re.search(r' d="[^"]*\.\d{3}', text)  # coordinates to a hundredth of a point
    assert len(text.encode()) < 8e6 / 2  # two of the four packaged scenes
    assert text.lstrip().startswith("<!DOCTYPE html>") and not parsed.open


def test_ids_are_unique_and_links_lead_somewhere(whole: tuple[str, Page]) -> None:
    _, parsed = whole
    assert len(parsed.ids) == len(set(parsed.ids))
    assert {a[1:] for a in parsed.addresses if a.startswith("#")} <= set(parsed.ids)


def test_has_landmarks_and_described_figures(whole: tuple[str, Page]) -> None:
    text, parsed = whole
    assert {"header", "nav", "main", "footer", "h1"} <= set(parsed.tags)
    plots = re.findall(r'<svg class="plot"[^>]*>', text)
    assert len(plots) >= 2 * 12 and all('role="img"' in plot and "aria-labelledby" in plot for plot in plots)


def test_figures_follow_the_colours_of_the_page(whole: tuple[str, Page]) -> None:
    text, _ = whole
    assert "prefers-color-scheme: dark" in text
    parts = re.findall(r'<svg class="plot".*?</svg>|[.]plot [.]s\d+[{][^}]*[}]', text, re.DOTALL)
    drawn = re.sub(r"<image[^>]*/?>", "", "".join(parts))
    assert set(re.findall(r"#[0-9a-f]{6}\b", drawn)) <= {"#000000"}  # clip paths and markers' definitions
    assert "#ffffff" not in drawn and "var(--nurbs)" in drawn


def test_says_everything_about_every_run_and_check(whole: tuple[str, Page]) -> None:
    _, parsed = whole
    for given in (scene_report(), scene_report("dcb-czm2")):
        for run in given.runs:
            assert all(part in parsed.text for part in (run.label, run.folder, run.command))
        for check in given.checks:
            assert all(part in parsed.text for part in (check.name, check.subject, check.meaning, number(check.value)))
    assert all(kind in parsed.text for kind in EVIDENCE) and all(text in parsed.text for text in EVIDENCE.values())
    assert all(f"{name} {value}" in parsed.text for name, value in ENVIRONMENT.items())


def test_summary_comes_first_and_lefm_has_no_error(whole: tuple[str, Page]) -> None:
    _, parsed = whole
    assert "All 12 checks hold on 2 scenes" in parsed.text
    distance = percent(
        curve_error(*((r.opening, r.load) for r in (made_up("x", 8e-4, 1, 1, 0), made_up("y", 4e-4, 1, 1, 0))))
    )
    assert parsed.text.index(f"NURBS: load within {distance} of DOLFINx") < parsed.text.index("What was solved")
    assert parsed.text.count("limit, not compared") == 4 and "LEFM limit: load" not in parsed.text


def test_process_zone_is_counted_in_elements_and_marked_where_they_are_too_few(tmp_path: Path) -> None:
    given = scene_report()
    crack = 4 + 2 * np.linspace(0, 1, 121)
    found = given.runs[0].result
    steps = found.steps | {"crack_length": crack, "damage_front": crack + 0.9}
    coarse = replace(found, steps=steps, dofs=280)
    had = given.scene.discretization.model_copy(update={"dofs": 280})
    scene = given.scene.model_copy(update={"discretization": had})
    few = replace(given.runs[0], result=coarse, label="coarse", scene=scene)
    runs = (few, replace(given.runs[0], label="fine"), given.runs[3])
    text, parsed = page(tmp_path, replace(given, runs=runs))
    table = re.search(r'<table class="zones">.*?</table>', text, re.DOTALL)[0]
    assert table.count("fewer than 3 elements") == 1 and table.count("fine enough") == 1
    assert "coarse 0.67 mm 0.89 mm 1.3 0.9 mm 1.3 " in re.sub(r"\s+", " ", Page(table).text)
    assert "cohesive beam" not in table  # it has no mesh


def test_says_how_a_run_ended_and_where_lumped_interface_points_are(tmp_path: Path) -> None:
    given = scene_report()
    whole = replace(given.runs[0].result, ending="separated at opening 5.2")
    mesh = given.scene.discretization.model_copy(update={"interface_rule": "lumped"})
    scene = given.scene.model_copy(update={"discretization": mesh})
    _, parsed = page(tmp_path, replace(changed(given, "nurbs", result=whole), scene=scene))
    assert "complete, separated at opening 5.2" in parsed.text and "lumped at the control points" in parsed.text


def test_meshes_are_drawn_before_they_are_deformed(whole: tuple[str, Page]) -> None:
    _, parsed = whole
    for label in ("NURBS p=3, 1952 unknowns: 224 elements", "Lagrange p=3, 1952 unknowns: 80 elements"):
        assert parsed.text.count(label) == 2  # scenes
    assert (
        parsed.text.index(" Meshes ") < parsed.text.index("Undeformed meshes") < parsed.text.index(" Deformed meshes ")
    )
    assert "T-junction" not in parsed.text  # none of these runs has any


def test_failing_check_is_marked(tmp_path: Path) -> None:
    given = replace(scene_report(), runs=scene_report().runs[0:4:3])
    bad = Check("peak", "nurbs / dolfinx", 0.07, 0.005, "cross-code", "Two codes find the same peak.")
    lost = Check("curve", "lagrange / beam", float("nan"), 0.02, "analytical", "The load follows that of a beam.")
    text, parsed = page(tmp_path, replace(given, checks=(*given.checks, bad, lost)))
    assert "2 broken of 8 checks" in parsed.text and parsed.text.count("✗ broken") == 2 + 2 + 1  # list, rows, overview
    assert "peak of nurbs / dolfinx, value 0.07, tolerance 0.005" in parsed.text
    assert "no value" in parsed.text and len(re.findall(r'<tr class="broken', text)) == 2


def test_says_why_dolfinx_is_missing_and_compares_with_the_beam(tmp_path: Path) -> None:
    given = changed(scene_report(), "dolfinx", result=None, left_out=DOLFINX_MISSING)
    _, parsed = page(tmp_path, given)
    assert DOLFINX_MISSING in parsed.text and all(way in parsed.text for way in DOLFINX_WAYS)
    assert (
        "Cohesive beam: the reference of this page" in parsed.text and "of cohesive beam over the whole" in parsed.text
    )


@pytest.mark.parametrize("rows", [0, 1, 2, 60])
def test_partial_run(tmp_path: Path, rows: int) -> None:
    given = replace(scene_report(), runs=scene_report().runs[0:4:3])  # NURBS and beam
    _, parsed = page(tmp_path, changed(given, "nurbs", result=stopped(given.runs[0].result, rows)))
    assert "NURBS p=3, 1952 unknowns stopped: no convergence; ask for more steps" in parsed.text
    assert rows < 2 or f"up to {quantity(given.runs[0].result.opening[rows - 1], 'mm', 3)}" in parsed.text


def test_nothing_but_reasons(tmp_path: Path) -> None:
    given = scene_report()
    runs = tuple(replace(run, result=None, left_out="failed: exit 137") for run in given.runs)
    _, parsed = page(tmp_path, replace(given, runs=runs, checks=()))
    assert "No check was made on 1 scene" in parsed.text and parsed.text.count("failed: exit 137") >= 5


def test_missing_columns_and_nan(tmp_path: Path) -> None:
    given = scene_report()
    for i, names in enumerate((CURVE_COLUMNS, ("opening", "load", "newton_iterations"))):
        steps = {name: given.runs[0].result.steps[name].copy() for name in CURVE_COLUMNS}
        for name in set(CURVE_COLUMNS) - set(names):
            steps[name][:] = np.nan
        bare = replace(given.runs[0].result, steps=steps, snapshots=(), seconds=None, peak_memory_mb=0.0)
        _, parsed = page(tmp_path / str(i), replace(given, runs=(replace(given.runs[0], result=bare),)))
        assert "No distance between curves" in parsed.text


def test_texts_are_escaped(tmp_path: Path) -> None:
    hostile = "<script>alert('$x$')</script>"
    scene = scene_report().scene.model_copy(update={"name": hostile, "units": f"N & {hostile}, mm, MPa"})
    given = replace(scene_report(), runs=changed(scene_report(), "nurbs", label=hostile, command=hostile).runs[0:4:3])
    text, parsed = page(tmp_path, replace(given, scene=scene))
    assert text.count("<script") == 2 and parsed.tags.count("script") == 2  # our own
    assert "<script>alert" not in text and hostile in parsed.text


def test_a_ladder_of_which_nothing_was_measured_has_a_sentence_and_no_chart(tmp_path: Path) -> None:
    price = Price(SCENE, against(), (a_row("nurbs", nan, nan), a_row("dolfinx", nan, nan, 540, 2)))
    report.write(report.Findings((), ENVIRONMENT, prices=(price,)), tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text()
    assert price.sentence in text and "Curve error against time" not in text and "<svg" not in text


def test_numbers_read_well() -> None:
    assert [number(v) for v in (0, 0.05, 0.0123456, 4.0, 120000.0, 1.4e-12, -2.5, float("nan"))] == [
        "0", "0.05", "0.0123", "4", "120\u202f000", "1.4\u00a0×\u00a010⁻¹²", "−2.5", "no value"
    ]  # fmt: skip
    assert [percent(v).replace("\u00a0", " ") for v in (0.00123, 0.02, 1e-9)] == ["0.12 %", "2.0 %", "< 0.0005 %"]
    assert " ".join(seconds(v) for v in (0.001, 8.72, 125.0)).split() == "< 0.1 s 8.7 s 2 min 5 s".split()


def test_drawn_path_is_the_cubic_through_values_and_slopes() -> None:
    x = np.linspace(0, 2, 33)
    result = Result("nurbs", {"opening": x, "load": x**3 - x, "load_slope": 3 * x**2 - 1})
    at, load = path(result)
    assert len(at) > 150 and np.allclose(load, at**3 - at, rtol=1e-13, atol=1e-13)
    assert len(path(replace(result, method="lefm"))[0]) == len(x)  # a kink has no slope
    steep = replace(result, steps=result.steps | {"load_slope": 3 * x**2 - 1 + 40 * (x == 1)})
    assert np.abs(path(steep)[1] - load).max() < 0.01 * 6  # no arc where it would be an invention


@pytest.mark.parametrize("name", ["dcb-czm1", "peel-60", "alfano-crisfield-weak"])
def test_inputs_are_those_of_the_scene(name: str) -> None:
    """Openings of the law from where its traction is the strength and where it is gone."""
    scene = load_scene(name)
    law, given = law_of(scene), scene.interface
    rows = {(group, label): value.replace("\u00a0", " ") for group, label, value in inputs(scene)}
    assert len(rows) == len(inputs(scene))

    def told(group: str, label: str) -> float:
        text = rows[group, label].replace("\u202f", "").replace("−", "-")
        mantissa, _, rest = text.partition(" × 10")
        power = rest.split(" ")[0].translate(str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-"))
        return float(mantissa.split(" ")[0]) * 10.0 ** (int(power) if power else 0)

    assert told("interface", "strength p_max") == pytest.approx(given.strength, rel=1e-5)
    assert told("interface", "toughness G_Ic") == pytest.approx(given.toughness, rel=1e-5)
    g_u, g_max = told("interface", "full opening g_u = 2 G_Ic / p_max"), told("interface", "opening at peak g_max")
    assert (g_u, g_max) == pytest.approx((law.g_open, law.g_peak), rel=1e-5)
    assert told("interface", "ductility g_u / g_max") == pytest.approx(g_u / g_max, rel=1e-4)
    assert told("interface", "contact penalty") == pytest.approx(given.penalty, rel=1e-5)
    for label, value in scene.specimen:
        if isinstance(value, float):
            assert told("specimen", label.replace("_", " ")) == pytest.approx(value, rel=1e-5)
    bodies = ("strip", "substrate") if scene.specimen.kind == "peel" else ("material",)
    constants = [value for body in bodies for _, value in getattr(scene, body) if value is not None]
    assert [told(*key) for key in rows if key[0] in bodies] == pytest.approx(constants, rel=1e-5)
    assert rows["isogeometric mesh", "target unknowns"] == str(scene.discretization.dofs)
    assert rows["DOLFINx mesh", "elements along"] == str(scene.dolfinx.elements)
