"""Several coupons of one plate: each reduced for itself, then mean, standard deviation and coefficient of variation."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, nan
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from verify.pages.style import HALF, Panel, drawing, panel
from verify.pages.table import Cell, Table
from verify.pages.template import rendered
from verify.pages.text import Units, axis
from verify.reduction.initiation import FIVE, NL, VIS
from verify.reduction.reduce import Reduced, Reduction, Value
from verify.scene.schema import Scene
from verify.studies.reduce.wording import with_interval
from verify.support.limited import read_at_most
from verify.support.refusal import Refusal, one_of

#: Keys of a specimen that a table of coupons may give, one column each.
COUPON_KEYS = ("precrack", "width", "arm_thickness", "length", "lever", "offset")
#: Values of a scheme that are averaged over coupons.
AVERAGED = (NL, FIVE, VIS, "propagation")


@dataclass(frozen=True)
class OneCoupon:
    """A file with what its specimen has of its own, as overrides of the scene."""

    path: Path
    overrides: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        return self.path.stem if self.path.suffix else self.path.name


def coupons_of(files: Sequence[Path], table: Path | None) -> tuple[OneCoupon, ...]:
    """The coupons of the command line, and those of a table with a column ``file`` and columns of `COUPON_KEYS`.

    Paths in the table count from its folder.

    Raises
    ------
    Refusal : no such table, no column file, another column, or an empty table.
    """
    found = [OneCoupon(path) for path in files]
    if table is None:
        return tuple(found)
    try:
        text = read_at_most(table).decode("utf-8-sig")
    except (OSError, ValueError) as error:
        raise Refusal(f"--coupons: {table}: must be a table of coupons (CSV in UTF-8), got: {error}") from None
    first = text.partition("\n")[0]
    mark = next((one for one in ";\t" if one in first), ",")  # with which numbers may have a decimal comma
    rows = [[cell.strip() for cell in row] for row in csv.reader(text.splitlines(), delimiter=mark) if any(row)]
    head = rows[0] if rows else []
    if other := [name for name in head if name not in ("file", *COUPON_KEYS)]:
        raise Refusal(
            f"--coupons: {table}: the columns must be file and some of {one_of(COUPON_KEYS)}, got {other[0]!r}"
        )
    if "file" not in head or len(rows) < 2:
        raise Refusal(f"--coupons: {table}: must have a column named file and a row for every coupon")
    for number, row in enumerate(rows[1:], 2):
        if len(row) != len(head):
            raise Refusal(f"--coupons: {table}:{number}: must have {len(head)} columns as above, got {len(row)}")
        given = dict(zip(head, row, strict=True))
        path = table.parent / given.pop("file")
        found.append(
            OneCoupon(path, tuple(f"specimen.{key}={value.replace(',', '.')}" for key, value in given.items() if value))
        )
    return tuple(found)


@dataclass(frozen=True)
class Statistic:
    """A value of a scheme over ``count`` coupons: mean, sample standard deviation, and their ratio."""

    scheme: str
    value: str
    count: int
    mean: float
    deviation: float

    @property
    def variation(self) -> float:
        return self.deviation / self.mean


def statistics(reductions: Sequence[Reduction]) -> tuple[Statistic, ...]:
    """Every scheme and value that two coupons or more have (ASTM D5528, 14.1.11)."""
    names = dict.fromkeys(one.name for found in reductions for one in found.schemes)
    made = []
    for name in names:
        schemes = [one for found in reductions for one in found.schemes if one.name == name and not one.missing]
        for value in AVERAGED:
            G = np.array([_value(one, value).value for one in schemes])
            G = G[np.isfinite(G)]
            if G.size > 1:
                made.append(Statistic(name, value, G.size, float(G.mean()), float(G.std(ddof=1))))
    return tuple(made)


def _value(one: Reduced, name: str) -> Value:
    return one.propagation if name == "propagation" else one.initiation.get(name, Value(nan))


HEADS = ("scheme", "value", "coupons", "mean", "standard deviation", "variation")


def lines_of(found: Sequence[Statistic]) -> list[tuple[str, ...]]:
    """Rows of the table of statistics, under `HEADS`."""
    return [
        (one.scheme, one.value, str(one.count), f"{one.mean:#.4g}", f"{one.deviation:#.3g}", f"{one.variation:.1%}")
        for one in found
    ]


def of_coupons(names: Sequence[str], reductions: Sequence[Reduction]) -> list[tuple[str, ...]]:
    """Propagation value of every scheme, a coupon a row; the first row names the schemes."""
    schemes = [
        name
        for name in dict.fromkeys(one.name for found in reductions for one in found.schemes)
        if any(isfinite(one.propagation.value) for found in reductions for one in found.schemes if one.name == name)
    ]
    rows = [("coupon", "precrack", *schemes)]
    for name, found in zip(names, reductions, strict=True):
        by_name = {one.name: with_interval(one.propagation) for one in found.schemes}
        rows.append((name, f"{found.coupon.precrack:g}", *(by_name[scheme] for scheme in schemes)))
    return rows


def write(names: Sequence[str], reductions: Sequence[Reduction], scene: Scene, path: Path) -> None:
    """Write the page: R-curves of all coupons, statistics, and a row a coupon."""
    units = Units.of(scene.units)
    unit = f", in {units.toughness}" if units.toughness else ""
    first, *rows = of_coupons(names, reductions)
    page = rendered(
        "verify.studies.reduce",
        "page.html.j2",
        {},
        source=f"{len(names)} coupons",
        sentence=f"Coupons of the scene {scene.name}, each with its own precrack.",
        panels=_r_curves(names, reductions, units),
        schemes=Table.of(HEADS, lines_of(statistics(reductions)), f"G over all coupons{unit}").html(),
        facts=Table.of(first, [(Cell(row[0]), *row[1:]) for row in rows], f"G while the crack grows{unit}").html(),
        remarks=[],
        models=[],
    )
    path.write_text(page, encoding="utf-8")


def _r_curves(names: Sequence[str], reductions: Sequence[Reduction], units: Units) -> list[Panel]:
    """A panel for every scheme: G over crack growth, a line a coupon."""
    schemes = dict.fromkeys(one.name for found in reductions for one in found.schemes if one.G.size)
    return [_panel(scheme, names, reductions, units) for scheme in schemes]


def _panel(scheme: str, names: Sequence[str], reductions: Sequence[Reduction], units: Units) -> Panel:
    with drawing():
        figure, axes = panel(HALF, 3.0)
        for name, found in zip(names, reductions, strict=True):
            _line(axes, name, next(one for one in found.schemes if one.name == scheme))
        axes.set(xlabel=axis("crack growth", units.length), ylabel=axis("G", units.toughness), ylim=(0.0, None))
        axes.legend(loc="lower right")
        caption = f"{scheme}: G over the growth of the crack, a line a coupon."
        return Panel.of(figure, f"coupons-{scheme.lower()}", f"R-curves by {scheme}", caption)


def _line(axes: Axes, name: str, one: Reduced) -> None:
    some = np.unique(np.linspace(0, max(one.G.size - 1, 0), min(one.G.size, 300)).astype(int))
    axes.plot(
        one.growth[some], one.G[some], linewidth=1.0, marker="o" if one.G.size <= 40 else "", markersize=3, label=name
    )
