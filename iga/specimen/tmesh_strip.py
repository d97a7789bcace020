"""T-meshes of bodies along an interface: many unknowns at the interface, where the crack runs, and few elsewhere.

Elements on the crack path are halved towards the interface, once for every layer: lines that halve the shortest
elements end on the interface itself, the next ones at the first layer, and so on. All T-junctions are ends of lines
across the body, so that no extensions cross: analysis-suitable whatever the numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from iga.bases.bspline import open_knots
from iga.tsplines.tmesh import DEGREE, FRAME, TMesh

#: Least thickness of the layer at the interface over the length of its elements.
STOCKY = 4.0


@dataclass(frozen=True)
class Strip:
    """A strip divided along and through.

    ``breaks_c`` (n_c + 1,) are the lines that run through its whole thickness; elements where ``halved_c`` (n_c,) is
    set are divided into 2^layers at the interface. Away from the interface each of the ``layers`` is twice as thick as
    the one before.
    """

    breaks_c: np.ndarray
    halved_c: np.ndarray
    layers: int = 1

    @property
    def functions(self) -> int:
        columns = len(self.breaks_c) - 1 + DEGREE
        return columns * (self.layers + DEGREE) + int(self.halved_c.sum()) * functions_of_halves(self.layers)

    def stocky(self, thickness: float) -> bool:
        """Whether the layer at the interface is thick enough for its elements, as `STOCKY` says."""
        shortest = float(np.diff(self.breaks_c)[self.halved_c].min(initial=np.inf)) / 2**self.layers
        return thickness / (2**self.layers - 1) >= STOCKY * shortest


def functions_of_halves(layers: int) -> int:
    """Number of functions that the 2^layers parts of one element add: for each line one on every row that it meets."""
    return sum(2 ** (layers - 1 - level) * (int(_top(level)) - FRAME + 1) for level in range(layers))


def strip_tmesh(strip: Strip, through: tuple[float, float], top: bool) -> TMesh:
    """The T-mesh of a strip.

    Parameters
    ----------
    through : coordinates of its lower and its upper side.
    top : the interface is on the upper side.
    """
    breaks, level_b = _lines(strip)
    heights = np.concatenate([[0.0], np.cumsum(2.0 ** np.arange(strip.layers))]) / (2**strip.layers - 1)
    knots_i, knots_j = open_knots(breaks, DEGREE).knots, open_knots(heights, DEGREE).knots
    across_ij = np.ones((len(knots_i) - 1, len(knots_j)), dtype=bool)
    top_i = np.full(len(knots_i), len(knots_j) - 1)
    top_i[DEGREE:-DEGREE] = np.where(level_b < strip.layers, _top(level_b), len(knots_j) - 1)
    up_ij = np.arange(len(knots_j) - 1) < top_i[:, None]
    low, high = through
    if top:
        knots_j, up_ij = 1.0 - knots_j[::-1], up_ij[:, ::-1]
    return TMesh(knots_i, low * (1.0 - knots_j) + high * knots_j, across_ij, up_ij)


def _lines(strip: Strip) -> tuple[np.ndarray, np.ndarray]:
    """Places (n_b,) of the lines across the body, and the level (n_b,) of each; full ones have the level ``layers``."""
    parts = 2**strip.layers
    share = np.arange(parts) / parts
    level = sum(((np.arange(parts) % 2**k) == 0).astype(int) for k in range(1, strip.layers + 1))
    x_cp = strip.breaks_c[:-1, None] * (1.0 - share) + strip.breaks_c[1:, None] * share
    kept_cp = strip.halved_c[:, None] | (level == strip.layers)
    level_cp = np.broadcast_to(level, x_cp.shape)
    return np.append(x_cp[kept_cp], strip.breaks_c[-1]), np.append(level_cp[kept_cp], strip.layers)


def _top(level: np.ndarray | int) -> np.ndarray:
    """Index of the knot across the body on which a line of a level ends; level 0 ends on the interface."""
    return np.where(np.asarray(level) == 0, FRAME, DEGREE + np.asarray(level))
