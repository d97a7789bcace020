"""A double cantilever beam by scikit-fem: quadrilaterals, and a bond between the facets of two bodies."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import bmat, coo_matrix, csr_matrix, diags
from scipy.sparse.linalg import splu
from skfem import (
    Basis,
    BilinearForm,
    ElementQuad1,
    ElementQuad2,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshQuad,
    asm,
)
from skfem.helpers import ddot, grad, identity, mul, sym_grad, transpose

from verify.export.mesh import scene_mesh
from verify.export.numbers import effects
from verify.result import Result, steps_from_rows
from verify.scene.materials import elastic_constants
from verify.scene.schema import counted_steps

ELEMENTS = {1: ElementQuad1, 2: ElementQuad2}
#: Residual over the largest nodal force, Newton iterations of a step at most, and halvings of a step at most.
TOLERANCE, ITERATIONS, HALVINGS = 1e-6, 20, 12
#: How the upper and the lower face move with the opening.
PARTS = np.array([0.5, -0.5])


def unsuitable(scene):
    """Why the solver is not made for a scene, or nothing."""
    if scene.specimen.kind != "dcb" or scene.specimen.plane != "stress" or scene.load.at != "face":
        return "only for a dcb in plane stress, pulled at its end faces"
    if scene.interface.slides or len({str(material) for material in scene.materials}) > 1:
        return "only for equal arms whose bond opens alone"
    return "" if scene.dolfinx.degree in ("auto", *ELEMENTS) else "dolfinx.degree: must be 1 or 2"


def solve(scene, on_step):
    """Load over opening; ``[dolfinx]`` of the scene sets elements, layers and degree."""
    model = Model.of(scene)
    state, rows, rejected = model.unloaded(), [], 0
    for start, end in zip((0.0, *scene.load.opening), scene.load.opening, strict=False):
        steps = max(round(counted_steps(scene) * abs(end - start) / travel(scene)), 1)
        done, part = 0.0, 1.0 / steps
        while done < 1.0:
            ahead = done + part if done + part < 1.0 - 1e-9 else 1.0  # no step of a rounding error
            new = model.newton(state, end - (1.0 - ahead) * (end - start))
            if new is not None:
                state, done, part = new, ahead, min(1.5 * part, 1.0 / steps)
                rows.append(model.row(state, np.sign(end - start)))
                on_step(rows[-1])
                continue
            rejected, part = rejected + 1, part / 2
            if part * steps < 2.0**-HALVINGS:
                return result(model, rows, rejected, f"stopped: no convergence after {state.opening:g}")
    return result(model, rows, rejected, "complete")


solve.unsuitable = unsuitable
#: Elements in the process zone on the coarsest mesh of `debond cost`, by the degree.
solve.degrees = {1: 4.0, 2: 1.0}


def travel(scene):
    """The way of the opening along the whole programme."""
    return np.abs(np.diff([0.0, *scene.load.opening])).sum()


def result(model, rows, rejected, status):
    return Result(
        "scikit-fem",
        steps_from_rows(rows),
        status,
        dofs=model.free.size,
        elements=model.bulk.mesh.nelements,
        rejected_steps=rejected,
        nonzeros=model.elastic.nnz,
    )


@dataclass(frozen=True)
class State:
    """Displacements, forces on both faces and the largest gaps so far, at a converged opening.

    ``rate`` are the derivatives by the opening of the free displacements and of the two forces.
    """

    opening: float
    pull: np.ndarray
    u: np.ndarray
    largest: np.ndarray
    rate: np.ndarray
    iterations: int


@dataclass(frozen=True)
class Model:
    """What no step changes.

    ``gap`` times u are the gaps at the points of the bond, each of which stands for ``area``; ``faces`` are the nodal
    forces of a unit load up on the upper and on the lower face, and times u the mean displacements of these.
    """

    finite: bool
    width: float
    D: np.ndarray
    law: "Law"
    bulk: Basis
    gap: csr_matrix
    area: np.ndarray
    faces: csr_matrix
    free: np.ndarray
    elastic: csr_matrix

    @staticmethod
    def of(scene):
        given = scene_mesh(scene)
        corners, conn = np.unique(given.conn_ea[:, :4], return_inverse=True)
        mesh = MeshQuad(*(np.ascontiguousarray(part.T) for part in (given.X_nI[corners], conn.reshape(-1, 4))))
        element = ElementVector(ELEMENTS[given.degree]())
        points = {"elem": element, "intorder": 2 * given.degree + 1}
        bulk = Basis(mesh, **points)
        near, a, thickness = 1e-9 * scene.specimen.length, scene.specimen.precrack, scene.specimen.arm_thickness

        def facets(body, inside):
            """Facets on the outline of a body, in the order of their middles."""
            found = mesh.facets_satisfying(inside, boundaries_only=True)
            found = found[given.body_e[mesh.f2t[0, found]] == body]
            return found[np.lexsort(mesh.p[:, mesh.facets[:, found]].mean(axis=1))]

        bonded = (facets(body, lambda x: (abs(x[1]) < near) & (x[0] > a - near)) for body in (0, 1))
        upper, lower = (FacetBasis(mesh, facets=side, **points) for side in bonded)
        faces = [facets(body, lambda x: x[0] < near) for body in (0, 1)]
        ends = [asm(UPWARDS, FacetBasis(mesh, facets=face, **points)) / thickness for face in faces]
        held = [bulk.nodal_dofs[i, np.searchsorted(corners, s.node_n)] for s in given.supports for i in s.components]
        c, finite = elastic_constants(scene.materials[0]), effects(scene)["kinematics"] == "finite"
        lateral = c["nu12"] * c["E2"] / c["E1"]
        D = np.array([[c["E1"], c["nu12"] * c["E2"], 0.0], [c["nu12"] * c["E2"], c["E2"], 0.0], [0.0, 0.0, 0.0]])
        D /= 1.0 - c["nu12"] * lateral
        D[2, 2] = c["G12"]
        return Model(
            finite=finite,
            width=scene.specimen.width,
            D=D,
            law=Law.of(scene),
            bulk=bulk,
            gap=heights(upper) - heights(lower),
            area=scene.specimen.width * upper.dx.ravel(),
            faces=csr_matrix(np.transpose(ends)),
            free=bulk.complement_dofs(np.concatenate(held)),
            elastic=scene.specimen.width * asm(ELASTIC, bulk, D=D),
        )

    def forces(self, u):
        """Forces of the bodies and their tangent."""
        if not self.finite:
            return self.elastic @ u, self.elastic
        at = {"D": self.D, "before": self.bulk.interpolate(u)}
        return self.width * asm(INTERNAL, self.bulk, **at), self.width * asm(TANGENT, self.bulk, **at)

    def unloaded(self):
        u = self.bulk.zeros()
        return self.at(0.0, np.zeros(2), u, np.zeros(self.area.size), self.forces(u)[1], 0)

    def at(self, opening, pull, u, largest, tangent, iterations):
        """A converged state, with the way in which it goes on; ``tangent`` is that of the bodies."""
        _, slope = self.law.traction(self.gap @ u, largest)
        rate = self.factors(tangent, slope).solve(np.append(np.zeros(self.free.size), -PARTS))
        return State(opening, pull, u, largest, rate, iterations)

    def row(self, state, heading):
        return {
            "opening": state.opening,
            "load": state.pull[0],
            "load_slope": state.rate[-2],
            "heading": heading,
            "dissipated_energy": self.area @ self.law.dissipated(state.largest),
            "newton_iterations": state.iterations,
        }

    def factors(self, tangent, slope):
        """Those of the tangent of bodies and bond, bordered by both faces."""
        tangent = (tangent + self.gap.T @ diags(self.area * slope) @ self.gap)[self.free][:, self.free]
        faces = self.faces[self.free]
        return splu(bmat([[tangent, -faces], [-faces.T, None]]).tocsc())

    def newton(self, start, opening):
        """The state at an opening, or None where the iterations do not converge."""
        u, way = start.u.copy(), (opening - start.opening) * start.rate
        u[self.free] += way[:-2]
        pull = start.pull + way[-2:]
        for iteration in range(1, ITERATIONS + 1):
            gap = self.gap @ u
            traction, slope = self.law.traction(gap, start.largest)
            force, tangent = self.forces(u)
            residual = (force + self.gap.T @ (self.area * traction) - self.faces @ pull)[self.free]
            if np.abs(residual).max() < TOLERANCE * np.abs(force).max():
                return self.at(opening, pull, u, self.law.history(gap, start.largest), tangent, iteration)
            off = self.faces.T @ u - opening * PARTS
            change = self.factors(tangent, slope).solve(np.append(-residual, off))
            u[self.free] += change[:-2]
            pull = pull + change[-2:]
        return None


@dataclass(frozen=True)
class Law:
    """Bilinear: damage grows with the largest gap between ``begins`` and ``open``; ``closed`` is the stiffness then."""

    stiffness: float
    begins: float
    open: float
    closed: float
    stays: bool

    @staticmethod
    def of(scene):
        bond, with_effects = scene.interface, effects(scene)
        opened = 2 * bond.toughness / bond.strength
        begins = opened / bond.ductility
        stiffness = bond.strength / begins
        closed = bond.penalty if with_effects["contact"] else 0.0
        return Law(stiffness, begins, opened, closed, with_effects["irreversible"])

    def history(self, gap, largest):
        return np.maximum(gap, largest) if self.stays else gap

    def dissipated(self, largest):
        """Energy per area."""
        k = np.clip(largest, self.begins, self.open)
        return 0.5 * self.stiffness * self.begins * self.open * (k - self.begins) / (self.open - self.begins)

    def traction(self, gap, largest):
        """Traction and its slope."""
        k = np.clip(self.history(gap, largest), self.begins, self.open)
        secant = self.stiffness * self.begins / k * (self.open - k) / (self.open - self.begins)
        softens = (gap >= self.history(gap, largest)) & (gap > self.begins) & (gap < self.open)
        slope = np.where(softens, -self.stiffness * self.begins / (self.open - self.begins), secant)
        pressed = (gap < 0.0) & (self.closed > 0.0)
        return np.where(pressed, self.closed, secant) * gap, np.where(pressed, self.closed, slope)


def heights(basis):
    """Matrix that gives u_y at the points of a basis on facets."""
    point = np.arange(basis.dx.size).reshape(basis.dx.shape)
    dofs = [np.broadcast_to(dof[:, None], point.shape) for dof in basis.element_dofs]
    values = [np.broadcast_to(function[0].value[1], point.shape) for function in basis.basis]
    at = (np.ravel([point] * len(dofs)), np.ravel(dofs))
    found = coo_matrix((np.ravel(values), at), shape=(point.size, basis.N)).tocsr()
    found.eliminate_zeros()
    return found


def stress(D, e):
    """D : e of the strains e (2, 2, ...)."""
    xx, yy = (D[i, 0] * e[0, 0] + D[i, 1] * e[1, 1] for i in range(2))
    xy = D[2, 2] * (e[0, 1] + e[1, 0])
    return np.array([[xx, xy], [xy, yy]])


def green(H, G):
    """Change of the Green-Lagrange strain at the displacement gradient H in the direction G."""
    change = mul(transpose(identity(H) + H), G)
    return 0.5 * (change + transpose(change))


UPWARDS = LinearForm(lambda v, w: v[1])
ELASTIC = BilinearForm(lambda u, v, w: ddot(stress(w.D, sym_grad(u)), sym_grad(v)))


@LinearForm
def INTERNAL(v, w):
    H = grad(w.before)
    return ddot(stress(w.D, 0.5 * (H + transpose(H) + mul(transpose(H), H))), green(H, grad(v)))


@BilinearForm
def TANGENT(u, v, w):
    H = grad(w.before)
    S = stress(w.D, 0.5 * (H + transpose(H) + mul(transpose(H), H)))
    return ddot(stress(w.D, green(H, grad(u))), green(H, grad(v))) + ddot(mul(grad(u), S), grad(v))
