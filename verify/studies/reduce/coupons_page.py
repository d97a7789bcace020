"""The page of several coupons: R-curves of all coupons, statistics, and a row a coupon."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from verify.pages.style import HALF, Panel, drawing, panel
from verify.pages.table import Cell, Table
from verify.pages.text import Units, axis
from verify.reduction.reduce import Reduction
from verify.scene.schema import Scene
from verify.studies.page import write_template
from verify.studies.reduce.coupons import HEADS, lines_of, of_coupons, statistics
from verify.studies.reduce.page import of_growth


def write(names: Sequence[str], reductions: Sequence[Reduction], scene: Scene, path: Path) -> None:
    """Write the page; a panel for every scheme has a line a coupon."""
    units, panels = Units.of(scene.units), list[Panel]()
    unit = f", in {units.toughness}" if units.toughness else ""
    first, *rows = of_coupons(names, reductions)
    with drawing():
        for scheme in dict.fromkeys(one.name for found in reductions for one in found.schemes if one.G.size):
            figure, axes = panel(HALF, 3.0)
            for name, found in zip(names, reductions, strict=True):
                of_growth(axes, found.by_name[scheme], label=name)
            axes.set(xlabel=axis("crack growth", units.length), ylabel=axis("G", units.toughness), ylim=(0.0, None))
            axes.legend(loc="lower right")
            caption = f"{scheme}: G over the growth of the crack, a line a coupon."
            panels.append(Panel.of(figure, f"coupons-{scheme.lower()}", f"R-curves by {scheme}", caption))
    write_template(
        "verify.studies.reduce",
        path,
        source=f"{len(names)} coupons",
        sentence=f"Coupons of the scene {scene.name}, each with its own precrack.",
        panels=panels,
        schemes=Table.of(HEADS, lines_of(statistics(reductions)), f"G over all coupons{unit}").html(),
        facts=Table.of(first, [(Cell(row[0]), *row[1:]) for row in rows], f"G while the crack grows{unit}").html(),
        remarks=[],
        models=[],
    )
