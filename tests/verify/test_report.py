"""The report, on made-up runs whose shape is that of real ones."""

from __future__ import annotations

import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from verify import report  # noqa: E402
from verify.curve import curve_error  # noqa: E402
from verify.methods import DOLFINX_MISSING, DOLFINX_WAYS  # noqa: E402
from verify.report.agreement import path  # noqa: E402
from verify.report.summary import KINDS  # noqa: E402
from verify.report.text import number, percent, quantity, seconds  # noqa: E402
from verify.result import CURVE_COLUMNS, Result, Snapshot  # noqa: E402
from verify.scene import load_scene  # noqa: E402
from verify.verdict import Check, Run, SceneReport  # noqa: E402

LENGTH, ARM, PRECRACK = 14.0, 0.2, 4.0
ENVIRONMENT = {"python": "3.11", "numpy": "2.0", "machine": "x86_64, 2 cores", "threads": "1"}


def curve(wobble: float = 0.0, spacing: float = 0.125) -> dict[str, np.ndarray]:
    """A beam with a rounded peak: elastic branch, softening, then P = P(crack length); all columns close."""
    x = np.linspace(0, 3, 151)
    stiffness, toughness = 1.23, 0.1
    crack = np.maximum(5.1 * np.sqrt(x), PRECRACK)
    propagation = 0.4362 * np.maximum(x, 0.3) ** -0.5
    load = 1 / ((1 / np.maximum(stiffness * x, 1e-12)) ** 6 + propagation**-6.0) ** (1 / 6)
    load *= 1 + wobble * np.sin(2 * np.pi * crack / spacing) * (x > 0.7)
    j = np.minimum((x / 0.62) ** 2, 1.0) * (1 + 0.3 * wobble * np.sin(9 * x))
    work = np.concatenate([[0], np.cumsum(np.diff(x) * (load[1:] + load[:-1]) / 2)])
    stored = np.minimum(load * x / 2, work)
    return {
        "opening": x,
        "load": load,
        "crack_length": crack,
        "stored_energy": stored,
        "dissipated_energy": (work - stored) * (1 - 1e-5),
        "external_work": work,
        "newton_iterations": np.where(x > 0, 4.0, 0.0),
        "load_slope": np.gradient(load, x),
        "face_slope_top": np.divide(j * toughness, 2 * load, out=np.zeros_like(x), where=load > 0),
        "face_slope_bottom": -np.divide(j * toughness, 2 * load, out=np.zeros_like(x), where=load > 0),
        "face_energy": np.zeros_like(x),
        "cohesive_energy": 0.05 * stored,
    }


def snapshot(opening: float, tip: float, elements: int, ripple: float) -> Snapshot:
    """Two arms bent apart up to ``tip``, a bilinear traction ahead of it."""
    s = np.linspace(PRECRACK, LENGTH, 2 * elements + 1)
    gap = 0.05 * np.maximum(1 - (s - tip) / 0.9, 0) ** 2
    damage = np.clip((gap - 0.004) / (0.05 - 0.004), 0, 1)
    far = np.exp(-(s - tip) / 0.4) * np.cos((s - tip) / 0.4)
    traction = np.where(
        damage >= 1, 0, np.where(damage > 0, 4 * (0.05 - gap) / 0.046, 4 * far + ripple * np.sin(40 * s))
    )
    k = np.linspace(0, 1, 4)
    left = np.linspace(0, LENGTH, elements, endpoint=False)
    x = (left[:, None] + k * LENGTH / elements)[:, :, None] * np.ones(4)
    grids, shifts, stresses = [], [], []
    for sign in (1, -1):
        y = sign * ARM * k[None, None, :] * np.ones_like(x)
        bend = opening / 2 * np.maximum(1 - x / tip, 0) ** 2 * (1 + x / tip / 2)
        grids.append(np.stack([x, y], axis=-1))
        shifts.append(np.stack([0 * x, sign * bend], axis=-1))
        stresses.append(900 * np.maximum(1 - np.abs(x - tip) / tip, 0) * (1 - 2 * k) * np.ones_like(x))
    fields = (np.concatenate(part) for part in (grids, shifts, stresses))
    return Snapshot(opening, 0.4, s, gap, traction, damage, *fields)


def made_up(method: str, wobble: float, total: float, dofs: int, elements: int) -> Result:
    places = ((0.62, 4.2), (1.0, 5.1), (3.0, 9.0))
    snapshots = tuple(snapshot(o, tip, elements, 10 * wobble) for o, tip in places) if elements else ()
    shares = {"mesh": 0.02, "basis": 0.05, "assembly": 0.4, "factor": 0.35, "solve": 0.1, "other": 0.08}
    times = {name: share * total for name, share in shares.items()} | {"total": total}
    return Result(
        method,
        curve(wobble),
        dofs=dofs,
        elements=2 * elements,
        snapshots=snapshots,
        seconds=times,
        peak_memory_mb=180.0,
    )


def limit() -> Result:
    x = np.linspace(0, 3, 61)
    load = np.minimum(1.25 * x, 0.4362 * np.maximum(x, 0.1) ** -0.5)
    nothing = np.full_like(x, np.nan)
    names = ("crack_length", "stored_energy", "dissipated_energy", "external_work", "newton_iterations")
    return Result("lefm", {"opening": x, "load": load, **dict.fromkeys(names, nothing)})


def run(name: str, label: str, result: Result) -> Run:
    method = result.method
    return Run(label, method, result, "", f"{name}/{method}", f"debond solve {name} --method {method} --fields")


def scene_report(name: str = "dcb-czm1") -> SceneReport:
    runs = (
        run(name, "NURBS p=3, 1952 unknowns", made_up("nurbs", 8e-4, 8.7, 1952, 112)),
        run(name, "Lagrange p=3, 1952 unknowns", made_up("lagrange", 9e-3, 9.4, 1952, 40)),
        run(name, "DOLFINx p=2, 2700 unknowns", made_up("dolfinx", 4e-4, 11.2, 2700, 112)),
        run(name, "cohesive beam", made_up("beam", 0.0, 0.3, 0, 0)),
        run(name, "LEFM", limit()),
    )
    checks = (
        Check("j-integral", "nurbs", 1.4e-3, 5e-3, "exact", "J is the area under the traction law."),
        Check("j-integral", "dolfinx", 1.1e-3, 5e-3, "exact", "J is the area under the traction law."),
        Check("energy-ledger", "nurbs", 2.2e-5, 5e-3, "exact", "Work is stored or dissipated."),
        Check("interface-force", "nurbs", 3.1e-12, 1e-8, "exact", "The interface tractions carry the load."),
        Check("beam-curve", "nurbs / beam", 3.9e-3, 5e-3, "analytical", "The load follows that of a beam."),
        Check("curve", "nurbs / dolfinx", 1.2e-3, 3e-3, "cross-code", "Two codes draw the same curve."),
    )
    return SceneReport(load_scene("dcb-czm1").model_copy(update={"name": name}), runs, checks)


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
    report.write(reports, folder / "report.html", ENVIRONMENT)
    text = (folder / "report.html").read_text(encoding="utf-8")
    return text, Page(text)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Page]:
    """Two scenes with everything there; tests that change nothing share it."""
    return page(tmp_path_factory.mktemp("report"), scene_report(), scene_report("dcb-czm2"))


def test_asks_nothing_of_the_network(whole: tuple[str, Page]) -> None:
    text, parsed = whole
    assert all(a.startswith(("#", "data:image/png;base64,", "./")) for a in parsed.addresses)
    assert not {"script", "link", "iframe", "object", "embed"} & set(parsed.tags)
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
    drawn = re.sub(r"<image[^>]*/?>", "", "".join(re.findall(r'<svg class="plot".*?</svg>', text, re.DOTALL)))
    assert set(re.findall(r"#[0-9a-f]{6}\b", drawn)) <= {"#000000"}  # clip paths and markers' definitions
    assert "#ffffff" not in drawn and "var(--nurbs)" in drawn


def test_says_everything_about_every_run_and_check(whole: tuple[str, Page]) -> None:
    _, parsed = whole
    for given in (scene_report(), scene_report("dcb-czm2")):
        for run in given.runs:
            assert all(part in parsed.text for part in (run.label, run.folder, run.command))
        for check in given.checks:
            assert all(part in parsed.text for part in (check.name, check.subject, check.meaning, number(check.value)))
    assert all(kind in parsed.text for kind in KINDS) and all(text in parsed.text for text in KINDS.values())
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
    assert "2 of 8 checks fail" in parsed.text and parsed.text.count("✗ fails") == 2 + 1  # rows, overview
    assert "peak of nurbs / dolfinx, value 0.07, tolerance 0.005" in parsed.text
    assert "no value" in parsed.text and len(re.findall(r'<tr class="failed', text)) == 2


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
    assert "<script" not in text and "script" not in parsed.tags and hostile in parsed.text


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
