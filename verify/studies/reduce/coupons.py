"""Several coupons of one plate: each reduced for itself, then mean, standard deviation and coefficient of variation."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import isfinite
from pathlib import Path

import numpy as np

from verify.reduction.initiation import FIVE, NL, VIS
from verify.reduction.reduce import Reduction
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
    made = []
    for name, value in product(reductions[0].by_name, AVERAGED):
        G = np.array([found.by_name[name].at(value).value for found in reductions])
        G = G[np.isfinite(G)]
        if G.size > 1:
            made.append(Statistic(name, value, G.size, float(G.mean()), float(G.std(ddof=1))))
    return tuple(made)


HEADS = ("scheme", "value", "coupons", "mean", "standard deviation", "variation")


def lines_of(found: Sequence[Statistic]) -> list[tuple[str, ...]]:
    """Rows of the table of statistics, under `HEADS`."""
    return [
        (one.scheme, one.value, str(one.count), f"{one.mean:#.4g}", f"{one.deviation:#.3g}", f"{one.variation:.1%}")
        for one in found
    ]


def of_coupons(names: Sequence[str], reductions: Sequence[Reduction]) -> list[tuple[str, ...]]:
    """Propagation value of every scheme, a coupon a row; the first row names the schemes."""
    columns = {name: [found.by_name[name].propagation for found in reductions] for name in reductions[0].by_name}
    columns = {name: values for name, values in columns.items() if any(isfinite(one.value) for one in values)}
    cells = zip(*(map(with_interval, values) for values in columns.values()), strict=True)
    rows = zip(names, (f"{found.coupon.precrack:g}" for found in reductions), cells, strict=True)
    return [("coupon", "precrack", *columns), *((name, precrack, *row) for name, precrack, row in rows)]
