"""The report as a file: it stands alone, says what is wrong at its top, and no text of a user becomes markup."""

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
from made_up_runs import ENVIRONMENT, scene_report  # noqa: E402

from verify import report  # noqa: E402
from verify.methods.dolfinx import DOLFINX_MISSING, DOLFINX_WAYS  # noqa: E402
from verify.pages.text import number, quantity  # noqa: E402
from verify.result import CURVE_COLUMNS, Result  # noqa: E402
from verify.studies.cost.price import Price  # noqa: E402
from verify.verdict import Check, SceneReport  # noqa: E402


def changed(given: SceneReport, method: str, **changes: object) -> SceneReport:
    """The report with one run's fields replaced."""
    runs = tuple(replace(run, **changes) if run.method == method else run for run in given.runs)
    return replace(given, runs=runs)


def few(given: SceneReport) -> SceneReport:
    """NURBS and the beam alone, which are quick to draw."""
    return replace(given, runs=given.runs[0:4:3])


class Page(HTMLParser):
    """Addresses, ids, tags and text of a page; complains about tags that do not match."""

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


def page(folder: Path, *reports: SceneReport) -> Page:
    report.write(report.Findings(reports, ENVIRONMENT), folder / "report.html")
    return Page((folder / "report.html").read_text(encoding="utf-8"))


def test_stands_alone_and_links_lead_somewhere(tmp_path: Path) -> None:
    parsed = page(tmp_path, scene_report(), few(scene_report("dcb-czm2")))
    text = (tmp_path / "report.html").read_text()
    assert all(a.startswith(("#", "data:image/png;base64,", "./")) for a in parsed.addresses)
    assert not {"link", "iframe", "object", "embed"} & set(parsed.tags) and not parsed.open
    assert not re.search(r"fetch\(|XMLHttpRequest|WebSocket|import\(|sendBeacon", text)
    assert not re.search(r"url\((?!#)|@import|https?://(?!www\.w3\.org/)", text)
    assert len(parsed.ids) == len(set(parsed.ids))
    assert {a[1:] for a in parsed.addresses if a.startswith("#")} <= set(parsed.ids)
    for run in (*scene_report().runs, *few(scene_report("dcb-czm2")).runs):
        assert all(part in parsed.text for part in (run.label, run.folder, run.command))
    for check in scene_report().checks:
        assert all(part in parsed.text for part in (check.name, check.subject, check.meaning, number(check.value)))
    assert all(f"{name} {value}" in parsed.text for name, value in ENVIRONMENT.items())


def test_a_check_that_fails_is_told_before_the_first_scene(tmp_path: Path) -> None:
    given = few(scene_report())
    bad = Check("peak", "nurbs / dolfinx", 0.07, 0.005, "cross-code", "Two codes find the same peak.")
    lost = Check("curve", "lagrange / beam", nan, 0.02, "analytical", "The load follows that of a beam.")
    parsed = page(tmp_path, replace(given, checks=(*given.checks, bad, lost)))
    top = parsed.text.split("What the checks rest on")[0]
    assert "2 broken of 8 checks" in top and "peak nurbs / dolfinx 0.07 0.005 cross-code" in top
    assert top.count("✗ broken") == 3 and parsed.text.count("✗ broken") == 5, (
        "in the list and overview, and the section"
    )


def test_says_why_dolfinx_is_missing_and_compares_with_the_beam(tmp_path: Path) -> None:
    text = page(tmp_path, changed(scene_report(), "dolfinx", result=None, left_out=DOLFINX_MISSING)).text
    assert DOLFINX_MISSING in text and all(way in text for way in DOLFINX_WAYS)
    assert "Cohesive beam: the reference of this page" in text and "of cohesive beam over the whole" in text


@pytest.mark.parametrize("rows", [0, 1, 2, 60])
def test_a_run_that_stopped_is_named_and_its_numbers_end_where_it_did(tmp_path: Path, rows: int) -> None:
    given = few(scene_report())
    whole = given.runs[0].result
    steps = {name: values[:rows] for name, values in whole.steps.items()}
    cut = replace(whole, steps=steps, status="stopped: no convergence", snapshots=())
    text = page(tmp_path, changed(given, "nurbs", result=cut)).text
    assert "NURBS p=3, 1952 unknowns stopped: no convergence" in text
    assert rows < 2 or f"up to {quantity(whole.opening[rows - 1], 'mm', 3)}" in text


def test_pages_are_written_whatever_is_missing(tmp_path: Path) -> None:
    given = scene_report()
    gone = tuple(replace(run, result=None, left_out="failed: exit 137") for run in given.runs)
    text = page(tmp_path / "gone", replace(given, runs=gone, checks=())).text
    assert "No check was made on 1 scene" in text and text.count("failed: exit 137") >= 5
    for i, names in enumerate((CURVE_COLUMNS, ("opening", "load", "newton_iterations"))):
        steps = {name: given.runs[0].result.steps[name].copy() for name in CURVE_COLUMNS}
        for name in set(CURVE_COLUMNS) - set(names):
            steps[name][:] = np.nan
        bare: Result = replace(given.runs[0].result, steps=steps, snapshots=(), seconds=None, peak_memory_mb=0.0)
        alone = replace(given, runs=(replace(given.runs[0], result=bare),))
        assert "No distance between curves" in page(tmp_path / str(i), alone).text


def test_texts_are_escaped(tmp_path: Path) -> None:
    hostile = "<script>alert('$x$')</script>"
    given = few(changed(scene_report(), "nurbs", label=hostile, command=hostile))
    scene = given.scene.model_copy(update={"name": hostile, "units": f"N & {hostile}, mm, MPa"})
    report.write(report.Findings((replace(given, scene=scene),), ENVIRONMENT), tmp_path / "report.html", text=True)
    text = (tmp_path / "report.html").read_text()
    assert "<script>alert" not in text and hostile in Page(text).text and Page(text).tags.count("script") == 1
    assert "<script>" not in (tmp_path / "report.md").read_text().replace("\\<", "")


def test_a_ladder_of_which_nothing_was_measured_has_a_sentence_and_no_chart(tmp_path: Path) -> None:
    price = Price(SCENE, against(), (a_row("nurbs", nan, nan), a_row("dolfinx", nan, nan, 540, 2)))
    report.write(report.Findings((), ENVIRONMENT, prices=(price,)), tmp_path / "report.html", text=True)
    text = (tmp_path / "report.html").read_text()
    assert price.sentence in text and "Curve error against time" not in text and "<svg" not in text
    assert price.sentence in (tmp_path / "report.md").read_text()
