"""Adaptive T-meshes that are analysis-suitable by construction: elements bisected in alternating directions.

Before an element is bisected, so are all coarser ones in the patch around it (Morgenstern, Peterseim 2015). Elements
of one patch then differ by one level at most, extensions of T-junctions never cross, and the number of elements that
are bisected beyond the marked ones stays in proportion to these.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from iga.tsplines.lines import from_rectangles
from iga.tsplines.tmesh import DEGREE, TMesh

#: Half the patch of an element in its own widths and heights: across the bisecting line, and along it. With degrees
#: p = q = 3 the half patch of Morgenstern and Peterseim 2015 is 2^{-k/2} (p//2 + 1/2, (q+1)//2 + 1/2) at an even
#: level k and 2^{-(k+1)/2} ((p+1)//2 + 1/2, 2 (q//2) + 1) at an odd one, lengths in elements of the initial grid.
ACROSS, ALONG = DEGREE // 2 + 0.5, (DEGREE + 1) // 2 + 0.5


@dataclass(frozen=True)
class Bisection:
    """Elements that came of a grid by bisection, even levels by vertical lines and odd ones by horizontal lines.

    ``breaks_s`` and ``breaks_t`` are the knot values of the initial grid. ``corner_ek`` (n_e, 2) are the lower left
    corners of the elements in units of that grid (dyadic, so exact), ``level_e`` (n_e,) how often each was bisected.
    """

    breaks_s: np.ndarray
    breaks_t: np.ndarray
    corner_ek: np.ndarray
    level_e: np.ndarray

    @cached_property
    def box_ek(self) -> np.ndarray:
        """Elements (n_e, 4) as s0, s1, t0, t1 in knot values."""
        high = self.corner_ek + _size(self.level_e)
        ends = np.stack([self.corner_ek, high], -1)
        breaks = (self.breaks_s, self.breaks_t)
        knots = [np.interp(ends[:, k], np.arange(len(breaks[k])), breaks[k]) for k in range(2)]
        return np.concatenate(knots, axis=1)

    @cached_property
    def tmesh(self) -> TMesh:
        """The T-mesh of the elements."""
        return from_rectangles(self.box_ek)

    def containing(self, x_ni: np.ndarray) -> np.ndarray:
        """Elements (n,) that hold points (n, 2) of the domain, given in knot values."""
        breaks = (self.breaks_s, self.breaks_t)
        unit_ni = np.stack([np.interp(x, b, np.arange(len(b))) for x, b in zip(x_ni.T, breaks, strict=True)], -1)
        unit_ni = np.minimum(unit_ni, np.nextafter([len(b) - 1.0 for b in breaks], 0.0))
        found: np.ndarray = np.full(len(x_ni), -1)
        for level in np.unique(self.level_e):
            e = self._lookup(level, np.floor(unit_ni / _size(level)).astype(np.int64))
            found = np.where(e >= 0, e, found)
        return found

    def closure(self, marked_e: np.ndarray) -> np.ndarray:
        """Elements (n_e,) to bisect so that the marked ones can be: coarser ones in their patches, and so on."""
        to_bisect = np.zeros(len(self.level_e), dtype=bool)
        to_bisect[marked_e] = True
        for level in range(int(self.level_e.max()), 0, -1):
            fine = np.flatnonzero(to_bisect & (self.level_e == level))
            coarse = self._lookup(level - 1, _coarser_cells(self.corner_ek[fine], level))
            to_bisect[coarse[coarse >= 0]] = True
        return to_bisect

    def refined(self, marked_e: np.ndarray) -> Bisection:
        """The elements after the marked ones (indices or a mask) and their closure were bisected.

        Raises
        ------
        ValueError : an element that is not there, or a mask of another length.
        """
        marked_e = np.asarray(marked_e)
        if marked_e.dtype == bool and marked_e.shape != self.level_e.shape:
            raise ValueError(f"marks must be a mask of {len(self.level_e)} elements, got {marked_e.size}")
        number = np.flatnonzero(marked_e) if marked_e.dtype == bool else marked_e.astype(int)
        if number.size and not (0 <= number.min() and number.max() < len(self.level_e)):
            raise ValueError(f"elements are 0 to {len(self.level_e) - 1}, got {number.min()} to {number.max()}")
        cut = self.closure(number)
        level, child = self.level_e[cut] + 1, self.corner_ek[cut]
        second = child + np.where((level % 2 == 1)[:, None], [1.0, 0.0], [0.0, 1.0]) * _size(level)
        return Bisection(
            self.breaks_s,
            self.breaks_t,
            np.concatenate([self.corner_ek[~cut], child, second]),
            np.concatenate([self.level_e[~cut], level, level]),
        )

    def _lookup(self, level: int, cell_nk: np.ndarray) -> np.ndarray:
        """Elements (n,) of one level at cells of its grid; -1 where there is none."""
        here = np.flatnonzero(self.level_e == level)
        number_ek = np.rint(self.corner_ek[here] / _size(level)).astype(np.int64)
        rows = round((len(self.breaks_t) - 1) / _size(level)[1])
        key, wanted = number_ek[:, 0] * rows + number_ek[:, 1], cell_nk[..., 0] * rows + cell_nk[..., 1]
        if here.size == 0:
            return np.full(wanted.shape, -1)
        order = np.argsort(key)
        place = np.minimum(np.searchsorted(key[order], wanted), len(key) - 1)
        inside = (cell_nk[..., 1] >= 0) & (cell_nk[..., 1] < rows) & (cell_nk[..., 0] >= 0)
        return np.where(inside & (key[order][place] == wanted), here[order][place], -1)


def initial(breaks_s: np.ndarray, breaks_t: np.ndarray) -> Bisection:
    """A grid, nothing bisected.

    Raises
    ------
    ValueError : breaks that do not rise.
    """
    breaks_s, breaks_t = np.asarray(breaks_s, dtype=float), np.asarray(breaks_t, dtype=float)
    for breaks, name in ((breaks_s, "s"), (breaks_t, "t")):
        if breaks.ndim != 1 or breaks.size < 2 or not np.all(np.diff(breaks) > 0.0):
            raise ValueError(f"breaks in {name} must be two numbers or more that rise, got {breaks}")
    t, s = np.meshgrid(np.arange(len(breaks_t) - 1.0), np.arange(len(breaks_s) - 1.0), indexing="ij")
    corner_ek = np.stack([s.ravel(), t.ravel()], -1)
    return Bisection(breaks_s, breaks_t, corner_ek, np.zeros(len(corner_ek), dtype=int))


def _size(level: np.ndarray | int) -> np.ndarray:
    """Width and height (..., 2) of the elements of a level, in units of the initial grid."""
    level = np.asarray(level)
    return np.stack([0.5 ** ((level + 1) // 2), 0.5 ** (level // 2)], -1)


def _coarser_cells(corner_nk: np.ndarray, level: int) -> np.ndarray:
    """Cells (n, n_c, 2) of the next coarser grid that overlap the patches of elements of one level."""
    size, coarse = _size(level), _size(level - 1)
    half = np.array([ACROSS, ALONG] if level % 2 == 0 else [ALONG, ACROSS])
    middle = corner_nk + size / 2
    first = np.floor((middle - half * size) / coarse).astype(np.int64)
    last = np.ceil((middle + half * size) / coarse).astype(np.int64) - 1
    count = np.max(last - first, axis=0, initial=0) + 1
    step = np.stack(np.meshgrid(*(np.arange(n) for n in count), indexing="ij"), -1).reshape(-1, 2)
    return np.minimum(first[:, None] + step, last[:, None])
