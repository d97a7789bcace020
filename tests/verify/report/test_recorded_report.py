"""All that the report says and draws of made-up runs, as recorded beside: cells of tables, lines of figures.

A change that is meant is recorded again by ``--force-regen``; the difference of the files shows what it changed.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from figures import Drawn, facts  # noqa: E402
from made_up_runs import ENVIRONMENT, made_up, run, scene_report  # noqa: E402

from verify import report  # noqa: E402
from verify.methods.dolfinx import DOLFINX_MISSING  # noqa: E402
from verify.pages.table import Cell, Table  # noqa: E402
from verify.report import cost, page  # noqa: E402
from verify.report.figures import curves, drawing, fields, meshes  # noqa: E402
from verify.report.section import Section  # noqa: E402
from verify.result import Result  # noqa: E402
from verify.scene.load import load_scene  # noqa: E402
from verify.verdict import Check, Run, SceneReport  # noqa: E402

KINDS = ("dcb-czm1", "adcb-czmtestkit-a", "peel-60", "enf-as4peek", "4enf", "mmb50-as4peek", "slb", "moments")
FAILS = Check("j-integral", "lagrange", 0.02, 0.005, "exact", "J is the area under the traction law.")
VAGUE = Check("curve", "beam", 1.0, 5e-3, "cross-code", "Two codes draw the same curve.", 0.1, "too coarse")


def cut(result: Result, rows: int, why: str) -> Result:
    """As if it had stopped after some rows, without fields."""
    steps = {name: column[:rows] for name, column in result.steps.items()}
    return replace(result, steps=steps, status=f"stopped: {why}", snapshots=(), rejected_steps=7)


def tmeshes() -> Result:
    """A mesh that follows the crack, with a line of the T-mesh that ends in the upper arm."""
    whole = made_up("tspline", 1e-3, 4.0, 700, 28)
    at = [(3.0 + x, snapshot) for x, snapshot in enumerate(whole.snapshots)]
    lines = [(np.array([[[x, 0.1], [x, 0.2]], [[x, 0.1], [14.0, 0.1]]]), np.array([[x, 0.1]])) for x, _ in at]
    kept = (replace(one, line_nki=a, junction_ni=b) for (_, one), (a, b) in zip(at, lines, strict=True))
    return replace(whole, snapshots=tuple(kept))


def reports() -> tuple[SceneReport, SceneReport]:
    """A scene as it should be. In another DOLFINx is missing, runs stopped, have no curve, and checks do not hold."""
    first, second = scene_report("first"), scene_report("second")
    meshes = [("nurbs-978", 1.6e-3, 978), ("nurbs-489", 3.2e-3, 489)]
    coarse = [replace(run("first", f"NURBS {n}", made_up("nurbs", w, 1.0, n, n // 18)), folder=f"first/{name}")
              for name, w, n in meshes]  # fmt: skip
    tsplines = replace(run("first", "T-splines", tmeshes()), key="0123456789abcdef" * 2)
    bare = [replace(one, result=replace(one.result, snapshots=())) for one in coarse]
    nurbs, lagrange, _, beam, lefm = (replace(one, result=replace(one.result, snapshots=())) for one in second.runs)
    runs = (
        replace(nurbs, result=cut(nurbs.result, 60, "here")),
        lagrange,
        run("second", "Lagrange p=3, 978 unknowns", made_up("lagrange", 2e-2, 5.0, 978, 0)),
        beam,
        lefm,
        Run("DOLFINx", "dolfinx", None, DOLFINX_MISSING),
        replace(nurbs, label="T-spline", method="tspline", folder="", result=cut(nurbs.result, 1, "at once")),
        Run("mine", "mine", None, "failed: exit 137"),
    )
    return (
        replace(first, runs=(*first.runs[:3], tsplines, *first.runs[3:], *bare), remarks=("a remark",)),
        replace(second, scene=published(second), runs=runs, checks=(*second.checks[:2], FAILS, VAGUE)),
    )


def published(given: SceneReport) -> Any:
    peak = {"quantity": "peak", "value": 1.0, "tolerance": 0.05, "kind": "cross-code", "source": "a book"}
    load = {**peak, "quantity": "load_at", "opening": 2.0, "value": [0.6, 0.7], "source": "another"}
    raw = {key: value for key, value in given.scene.model_dump().items() if value is not None}
    return type(given.scene).model_validate({**raw, "published": [peak, load]})


def told(cell: str | Cell) -> str:
    """A cell with all that it has."""
    if isinstance(cell, str):
        return cell
    more = [cell.below, cell.link, cell.tone, cell.id, *([cell.line.colour] if cell.line else [])]
    return " | ".join(filter(None, (cell.text, *more))).replace("\u00a0", " ")


Written = tuple[list[Table], Drawn, list[Section], Path]


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """All tables, figures and sections of the page, and where it is."""
    folder, tables, sections = tmp_path_factory.mktemp("report"), [], []
    with pytest.MonkeyPatch.context() as patch:
        drawn = Drawn(patch, cost, curves, drawing, fields, meshes)
        patch.setattr(page, "at_once", lambda work, items: sections.extend(map(work, items)) or sections)
        patch.setattr(Table, "html", lambda table, html=Table.html: tables.append(table) or html(table))
        report.write(report.Findings(reports(), ENVIRONMENT), folder / "report.html", text=True)
    return tables, drawn, sections, folder


def test_every_cell_of_every_table(written, data_regression):
    found = {}
    for i, table in enumerate(written[0]):
        if table.kind != "zones":  # of meshes that are made
            rows = [[column.title for column in table.columns], *table.cells()]
            found[f"{i} {table.caption}"] = [[*map(told, row)] for row in rows]
    data_regression.check(found)


def test_what_every_figure_draws(written, data_regression):
    data_regression.check({f"{i} {title}": facts(figure) for i, (title, figure) in enumerate(written[1])})


def test_what_stands_below_figures_and_which_are_folded(written, data_regression):
    data_regression.check(
        {
            f"{section.anchor} {group.title}": {
                "folded": group.folded,
                "legend": [entry.legend for entry in group.legend],
                "captions": {one.svg: f"{one.size}: {one.caption}" for one in group.panels},
            }
            for section in written[2]
            for group in section.figures
        }
    )


def test_all_words_of_the_report(written, file_regression):
    """In Markdown, which has every table of the page but those of its inputs."""
    tables, *_, folder = written
    text = (folder / "report.md").read_text()
    inputs = {"specimen", "material", "interface", "isogeometric mesh", "DOLFINx mesh"}
    shown = [table.markdown() for table in tables if table.caption not in inputs]
    assert all(table in text for table in shown) and len(shown) == 3 + 6 + 6 + 1
    words = [text := text.replace(table, "") for table in shown][-1]
    file_regression.check(words, extension=".md")


def test_specimens_with_their_loads_and_supports(data_regression, monkeypatch):
    found = {}
    for name in (*KINDS, "dcb-czm1 specimen.arm_thickness=1.5"):
        drawn, scene = Drawn(monkeypatch, drawing), load_scene(*(name.split()[0], name.split()[1:]))
        tip = scene.specimen.free_length
        caption = drawing.specimen(scene, "key", (tip, 1.1 * tip, 0.75)).caption
        found[name] = {"caption": caption, **facts(drawn[0][1])}
    data_regression.check(found)
