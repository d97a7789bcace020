"""Boundary loops: directed sides put in the order in which one walks around the body."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components, depth_first_order


def loops(start_c: np.ndarray, end_c: np.ndarray) -> tuple[np.ndarray, ...]:
    """Indices of the sides of each closed loop, in walking order.

    Parameters
    ----------
    start_c, end_c : (n_c,) vertex from which a side leaves and at which it arrives.

    Raises
    ------
    ValueError : sides that do not close, or a vertex at which more than one loop passes.
    """
    order = np.argsort(start_c, kind="stable")
    starts = start_c[order]
    if not np.array_equal(starts, np.sort(end_c)):
        raise ValueError("the boundary does not close: some side ends where no other begins")
    if np.any(starts[1:] == starts[:-1]):
        twice = starts[1:][starts[1:] == starts[:-1]][0]
        raise ValueError(f"the boundary touches itself at vertex {twice}, loops cannot be told apart there")
    n_c = len(start_c)
    following = order[np.searchsorted(starts, end_c)]
    graph = coo_array((np.ones(n_c), (np.arange(n_c), following)), shape=(n_c, n_c)).tocsr()
    _, first = np.unique(connected_components(graph, directed=False)[1], return_index=True)
    return tuple(depth_first_order(graph, start, return_predecessors=False) for start in first)
