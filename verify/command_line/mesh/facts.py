"""Facts of an extracted mesh: elements, T-junctions, extraordinary points, whether a solver takes it; of surfaces."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from iga.files.iga_format import IgaFile
from iga.mesh.bernstein import bernstein, bernstein_derivative, tensor
from iga.mesh.bezier import homogeneous, jacobian
from iga.mesh.continuity import jumps
from iga.mesh.edges import Sides, chains_of, element_sides
from iga.mesh.extraction import ElementBlock, Mesh
from iga.mesh.quadrature import gauss, square
from iga.mesh.rank import coefficients, rank
from iga.mesh.soundness import faults, unity_fault

#: Largest jump that counts as continuous; functions are of size 1, lengths are relative to the element.
CONTINUOUS = 1e-6

#: Jacobian, over the mean of its element, below which there are no spatial derivatives.
FLAT = 1e-9

#: Corners of an element and middles of its sides.
_OUTLINE = np.array([(s, t) for s in (0.0, 0.5, 1.0) for t in (0.0, 0.5, 1.0) if (s, t) != (0.5, 0.5)])


@dataclass(frozen=True)
class MeshFacts:
    """The facts of one mesh, each computed on first access."""

    mesh: Mesh

    @cached_property
    def sides(self) -> Sides:
        return element_sides(self.mesh)

    @cached_property
    def _vertices(self) -> tuple[np.ndarray, np.ndarray]:
        """Number of element corners at each vertex, and positions (n, 2)."""
        vertex_k = self.sides.vertex_kv[:, 0]  # every corner is the start of one side
        _, first = np.unique(vertex_k, return_index=True)
        return np.bincount(vertex_k), self.sides.points(first, np.zeros(len(first)))[:, :2]

    @cached_property
    def junctions(self) -> np.ndarray:
        """Positions (n, 2) of the T-junctions: vertices inside a side of another element."""
        return self._vertices[1][np.unique(self.sides.hanging[:, 0])]

    @cached_property
    def extraordinary(self) -> list[tuple[int, np.ndarray]]:
        """Valence and position of every inner vertex with other than four corners that is no T-junction."""
        corners_v, X_vI = self._vertices
        ordinary = corners_v == 4
        ordinary[self.sides.hanging[:, 0]] = True
        ordinary[self.sides.vertex_kv[~self.sides.shared_k].ravel()] = True
        return [(int(corners_v[v]), X_vI[v]) for v in np.flatnonzero(~ordinary)]

    @cached_property
    def loops(self) -> int:
        """Number of closed chains of the boundary; 0 where it touches itself."""
        return len(chains_of(self.sides, np.flatnonzero(~self.sides.shared_k)))

    @cached_property
    def weighted_unity(self) -> float:
        """Largest ``|sum_a w_a N_a - 1|``: zero for a semi-standard T-spline of weight one."""
        w_A = self.mesh.w_A
        sums = (np.einsum("ea,eab->eb", w_A[b.conn_ea], b.C_eab) for b in self.mesh.blocks)
        return max(float(np.abs(sum_eb - 1.0).max()) for sum_eb in sums)

    @cached_property
    def rank(self) -> int:
        """Number of linearly independent functions: of the matrix (n_A, n_eb) of all functions in the Bernstein
        polynomials of all elements."""
        return rank(coefficients(self.mesh))

    @cached_property
    def area(self) -> float:
        return sum(float(np.sum(det_eq @ w_q)) for det_eq, w_q in self._at_gauss_points(2, 4))

    @cached_property
    def smallest_jacobian(self) -> tuple[float, float]:
        """Smallest Jacobian at Gauss points, corners and middles of sides; smallest ratio to the mean of an element."""
        smallest, relative = [], []
        for number, (inside, w_q) in enumerate(self._at_gauss_points(1, 1)):
            least = np.minimum(inside.min(1), self._jacobian(number, _OUTLINE).min(1))
            mean = np.abs(inside @ w_q)
            smallest.append(float(least.min()))
            relative.append(float(np.divide(least, mean, out=np.zeros(len(mean)), where=mean > 0).min()))
        return min(smallest), min(relative)

    @cached_property
    def folded(self) -> int:
        """Number of elements with a Jacobian that is not positive at a Gauss point."""
        return sum(int(np.count_nonzero(~np.all(det_eq > 0, axis=1))) for det_eq, _ in self._at_gauss_points(1, 1))

    @cached_property
    def continuity(self) -> dict[str, int] | None:
        """Numbers of inner edges with jumps, C0, C1, and C2 or higher continuity; None for a folded mesh."""
        if self.smallest_jacobian[1] <= FLAT:
            return None
        _, other, t = self.sides.opposite
        try:
            k, jump_no = jumps(self.mesh, self.sides)
        except np.linalg.LinAlgError:  # a singular map at another point
            return None
        length, twins = self.sides.length_k, t == 0.5
        once = np.where(twins, k < other, length[k] <= length[other])
        order_n = np.cumprod(jump_no[once] < CONTINUOUS, axis=1).sum(1)
        names = ("broken", "C0", "C1", "C2")
        return {name: int(np.count_nonzero(order_n == i)) for i, name in enumerate(names)}

    @property
    def unsound(self) -> list[str]:
        """Reasons why a solver cannot use the mesh, a sentence each."""
        n_A, found = len(self.mesh.P_AI), []
        if self.folded:
            found.append(f"Jacobians are not positive on {self.folded} of {self.mesh.elements} elements")
        else:
            found += faults(self.mesh, self.sides)
        found += unity_fault(self.mesh)
        if self.rank < n_A:
            found.append(f"the functions are dependent: rank {self.rank} of {n_A}")
        return found

    def _at_gauss_points(self, times: int, more: int) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Jacobians (n_e, n_q) of every block and weights (n_q,) at ``times`` p + ``more`` points along each direction
        of degree p."""
        for number, block in enumerate(self.mesh.blocks):
            points_q, w_q = square(*(gauss(times * p + more) for p in block.degrees))
            yield self._jacobian(number, points_q), w_q

    def _jacobian(self, number: int, points_q: np.ndarray) -> np.ndarray:
        block = self.mesh.blocks[number]
        return jacobian(homogeneous(self.mesh.P_AI, self.mesh.w_A, block), block.degrees, points_q)


def facts_of_file(path: str, file: IgaFile) -> dict[str, Any]:
    """Facts of any file as numbers, lists and words; the area of a surface alone."""
    count: Counter[tuple[tuple[int, ...], int]] = Counter()
    for one in file.blocks:
        count[tuple(map(int, one.degrees)), one.C_eab.shape[1]] += len(one.C_eab)
    surface = all(len(one.degrees) == 2 for one in file.blocks)
    return {
        "file": path,
        "type": file.kind,
        "control_points": len(file.P_AI),
        "elements": len(file.block_e),
        "kinds": [
            {"degrees": list(degrees), "functions": functions, "elements": number}
            for (degrees, functions), number in sorted(count.items())
        ],
        "box": [file.P_AI.min(0).tolist(), file.P_AI.max(0).tolist()],
        "sets": [{"kind": one.kind, "name": one.name, "entries": len(one.ids)} for one in file.sets],
        "sum_of_functions_misses_one_by": max(float(np.abs(one.C_eab.sum(1) - 1.0).max()) for one in file.blocks),
        **({"area": float(sum(_areas(file, one).sum() for one in file.blocks))} if surface else {}),
    }


def facts_of_mesh(facts: MeshFacts) -> dict[str, Any]:
    """Further facts of a plane body."""
    smallest, relative = facts.smallest_jacobian
    return {
        "t_junctions": facts.junctions.tolist(),
        "extraordinary_points": [{"valence": valence, "at": x.tolist()} for valence, x in facts.extraordinary],
        "boundary_loops": facts.loops,
        "chains": {name: len(chain.element_c) for name, chain in facts.mesh.chains.items()},
        "weighted_sum_misses_one_by": facts.weighted_unity,
        "rank": facts.rank,
        "area": facts.area,
        "smallest_jacobian": smallest,
        "smallest_jacobian_relative": relative,
        "continuity": facts.continuity,
        "unsound": facts.unsound,
    }


def _areas(file: IgaFile, block: ElementBlock) -> np.ndarray:
    """Area (n_e,) of each element: the integral of ``|X_s x X_t|`` with X = h / W."""
    p, q = block.degrees
    points_q, w_q = square(gauss(p + 2), gauss(q + 2))
    s, t = points_q.T
    H_ebI = homogeneous(file.P_AI, file.w_A, block)
    h = tensor(bernstein(p, s), bernstein(q, t)) @ H_ebI
    h_s = tensor(bernstein_derivative(p, s), bernstein(q, t)) @ H_ebI
    h_t = tensor(bernstein(p, s), bernstein_derivative(q, t)) @ H_ebI
    X, W = h[..., :3] / h[..., 3:], h[..., 3:]
    X_s, X_t = ((one[..., :3] - X * one[..., 3:]) / W for one in (h_s, h_t))
    return np.linalg.norm(np.cross(X_s, X_t), axis=-1) @ w_q
