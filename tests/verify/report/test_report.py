"""The report as a file: it stands alone, whatever is missing, and no text of a user becomes markup."""

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
from verify.pages.text import quantity  # noqa: E402
from verify.report.tables import headline  # noqa: E402
from verify.studies.cost.study import Study  # noqa: E402
from verify.verdict import Counts, SceneReport  # noqa: E402


def changed(given: SceneReport, method: str, **changes: object) -> SceneReport:
    """The report with one run's fields replaced."""
    runs = tuple(replace(run, **changes) if run.method == method else run for run in given.runs)
    return replace(given, runs=runs)


def few(given: SceneReport) -> SceneReport:
    """NURBS and the beam alone, which are quick to draw."""
    return replace(given, runs=given.runs[0:4:3])


class Page(HTMLParser):
    """Attributes, tags and text of a page; complains about tags that do not match."""

    VOID = {"meta", "link", "img", "br", "hr", "input", "use", "path", "line", "rect", "image"}

    def __init__(self, text: str) -> None:
        super().__init__()
        self.attributes: list[tuple[str, str | None]] = []
        self.tags: list[str] = []
        self.open: list[str] = []
        self.text = ""
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += attrs
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag not in self.VOID:
            assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text = f"{self.text} {data.strip()}"


def page(folder: Path, *reports: SceneReport) -> Page:
    report.write(report.Findings(reports, ENVIRONMENT), folder / "report.html")
    return Page((folder / "report.html").read_text(encoding="utf-8"))


def test_stands_alone_and_links_lead_somewhere(tmp_path):
    parsed = page(tmp_path, few(scene_report()), few(scene_report("dcb-czm2")))
    text = (tmp_path / "report.html").read_text()
    where = [v for k, v in parsed.attributes if k in ("href", "src", "xlink:href", "srcset", "data", "action") and v]
    ids = [value for key, value in parsed.attributes if key == "id"]
    assert all(a.startswith(("#", "data:image/png;base64,", "./")) for a in where)
    assert not {"link", "iframe", "object", "embed"} & set(parsed.tags)
    assert not re.search(r"fetch\(|XMLHttpRequest|WebSocket|import\(|sendBeacon", text)
    assert not re.search(r"url\((?!#)|@import|https?://(?!www\.w3\.org/)", text)
    assert len(ids) == len(set(ids)) and {a[1:] for a in where if a.startswith("#")} <= set(ids)


@pytest.mark.parametrize(
    ("counts", "words"),
    [
        ((0, 0, 0, 1), "No check was made on 1 scene"),
        ((0, 0, 0, 0), "No check was made on 0 scenes"),
        ((1, 0, 0, 1), "The one check holds on 1 scene"),
        ((2, 0, 0, 2), "All 2 checks hold on 2 scenes"),
        ((2, 2, 1, 1), "2 of 5 checks hold on 1 scene, 2 are broken; 1 not judged"),
    ],
)
def test_the_verdict_is_one_line(counts, words):
    held, broken, unresolved, scenes = counts
    assert headline(Counts(held + broken + unresolved, held, broken, unresolved), scenes) == words


@pytest.mark.parametrize("rows", [0, 1, 2, 60])
def test_a_run_that_stopped_is_named_and_its_numbers_end_where_it_did(tmp_path, rows):
    given = few(scene_report())
    whole = given.runs[0].result
    steps = {name: values[:rows] for name, values in whole.steps.items()}
    cut = replace(whole, steps=steps, status="stopped: no convergence", snapshots=())
    text = page(tmp_path, changed(given, "nurbs", result=cut)).text
    assert "NURBS p=3, 1952 unknowns stopped: no convergence" in text
    assert rows < 2 or f"up to {quantity(whole.opening[rows - 1], 'mm', 3)}" in text


@pytest.mark.parametrize("kept", [("opening", "load"), ("opening", "load", "newton_iterations"), ()])
def test_pages_are_written_whatever_is_missing(kept, tmp_path):
    """All columns but some are unknown; or there is no result at all."""
    given = few(scene_report())
    steps = {name: c if name in kept else np.full_like(c, nan) for name, c in given.runs[0].result.steps.items()}
    bare = replace(given.runs[0].result, steps=steps, snapshots=(), seconds=None, peak_memory_mb=0.0)
    run = replace(given.runs[0], result=bare if kept else None, left_out="" if kept else "failed: exit 137")
    text = page(tmp_path, replace(given, runs=(run,), checks=())).text
    assert "No distance between curves" in text and "No check was made on 1 scene" in text
    assert ("failed: exit 137" in text) == (not kept)


def test_texts_are_escaped(tmp_path):
    hostile = "<script>alert('$x$')</script>"
    given = few(changed(scene_report(), "nurbs", label=hostile, command=hostile))
    scene = given.scene.model_copy(update={"name": hostile, "units": f"N & {hostile}, mm, MPa"})
    report.write(report.Findings((replace(given, scene=scene),), ENVIRONMENT), tmp_path / "report.html", text=True)
    text = (tmp_path / "report.html").read_text()
    assert "<script>alert" not in text and hostile in Page(text).text and Page(text).tags.count("script") == 1
    assert "<script>" not in (tmp_path / "report.md").read_text().replace("\\<", "")


def test_a_ladder_of_which_nothing_was_measured_has_a_sentence_and_no_chart(tmp_path):
    price = Study(SCENE, (a_row("nurbs", nan, nan), a_row("dolfinx", nan, nan, 540, 2)), (), against())
    report.write(report.Findings((), ENVIRONMENT, prices=(price,)), tmp_path / "report.html", text=True)
    text = (tmp_path / "report.html").read_text()
    assert price.sentence in text and price.sentence in (tmp_path / "report.md").read_text() and "<svg" not in text
