"""Akantu on one folder: its mesh, elements, interface elements and tangents; the path is followed here.

Needs Akantu, NumPy and SciPy, and nothing of debond.
"""

import json
import sys
from pathlib import Path

import numpy as np
from scipy.sparse import bmat, csr_matrix
from scipy.sparse.linalg import splu

#: Residual over the largest nodal force, Newton iterations of a step at most, and halvings of a step at most.
TOLERANCE, ITERATIONS, HALVINGS = 1e-6, 20, 12


class Model:
    """Forces and tangent of a model with interface elements along the group ``bond``.

    Akantu keeps the largest opening of every iteration, those of one that has gone astray as well, and steps after it
    cannot converge. So it is set back to that of the last step before each iteration.
    """

    def __init__(self, folder, degree):
        import akantu

        print("ready", flush=True)
        self.akantu = akantu
        akantu.parseInput(str(folder / "material.dat"))
        self.mesh = akantu.Mesh(2)
        self.mesh.read(str(folder / "mesh.msh"))
        self.model = akantu.SolidMechanicsModelCohesive(self.mesh)
        self.model.initFull(_analysis_method=akantu._static, _is_extrinsic=False)
        self.X = np.array(self.mesh.getNodes())
        self.elements = self.mesh.getNbElement(type=(akantu._quadrangle_4, akantu._quadrangle_8)[degree - 1])
        bond = next(one for one in self._materials() if one.getString("name") == "bond")
        kind = (akantu._cohesive_2d_4, akantu._cohesive_2d_6)[degree - 1]
        self.largest = bond.getInternalReal("delta max")(kind)

    def _materials(self):
        return (self.model.getMaterial(i) for i in range(self.model.getNbMaterials()))

    def forces(self, u, largest):
        """Internal forces (n,) for displacements u (n,), after the largest openings so far."""
        self.largest[:] = largest
        self.model.getDisplacement()[:] = u.reshape(-1, 2)
        self.model.assembleInternalForces()
        return -np.array(self.model.getInternalForce()).ravel()

    def tangent(self):
        self.model.assembleStiffnessMatrix()
        found = self.akantu.AkantuSparseMatrix(self.model.getDOFManager().getMatrix("K"))
        return csr_matrix((found.data, (found.row, found.col)), shape=(self.X.size, self.X.size))


def solve(folder):
    """Print a line for every step, and one at the end."""
    problem = json.loads((folder / "problem.json").read_text())
    model, width = Model(folder, problem["degree"]), problem["width"]
    parts = np.array([face["part"] for face in problem["faces"]])
    faces = np.zeros((model.X.size, 2))
    for column, face in zip(faces.T, problem["faces"], strict=True):
        column[2 * np.array(face["nodes"]) + 1] = face["weights"]
    faces, free = csr_matrix(faces), free_of(model.X, problem["held"])
    u, pull, largest = np.zeros(model.X.size), np.zeros(2), np.array(model.largest)
    programme, rejected, status = problem["programme"], 0, "complete"
    travel = np.abs(np.diff([0.0, *programme])).sum()
    for start, end in zip((0.0, *programme), programme, strict=False):
        steps = max(round(problem["steps"] * abs(end - start) / travel), 1)
        done, part = 0.0, 1.0 / steps
        while done < 1.0 and status == "complete":
            ahead = done + part if done + part < 1.0 - 1e-9 else 1.0  # no step of a rounding error
            opening = end - (1.0 - ahead) * (end - start)
            found = newton(model, faces, free, (u, pull, largest), opening * parts)
            if found is not None:
                u, pull, largest, iterations = found
                done, part = ahead, min(1.5 * part, 1.0 / steps)
                row = {"opening": opening, "load": width * pull[0], "newton_iterations": iterations}
                print("row", json.dumps(row), flush=True)
                continue
            rejected, part = rejected + 1, part / 2
            if part * steps < 2.0**-HALVINGS:
                status = f"stopped: no convergence on the way to {opening:g}"
    size = {"dofs": int(free.size), "elements": model.elements, "rejected_steps": rejected}
    print("end", json.dumps({"status": status, **size}), flush=True)


def free_of(X, held):
    """Unknowns without those of the supports: both faces of the end of the bond along x, one of them across."""
    near = 1e-9 * np.ptp(X[:, 0])
    nodes = np.flatnonzero(np.any([np.abs(X - place).max(axis=1) < near for place in held], axis=0))
    return np.setdiff1d(np.arange(X.size), np.append(2 * nodes, 2 * nodes[0] + 1))


def newton(model, faces, free, before, goal):
    """Displacements, forces on both faces and largest openings where the faces have moved by ``goal``, or None."""
    u, pull, largest = before
    u, loaded = u.copy(), faces[free]
    model.model.beforeSolveStep()
    for iteration in range(ITERATIONS + 1):
        force = model.forces(u, largest)
        residual = (force - faces @ pull)[free]
        off = faces.T @ u - goal
        if iteration and np.abs(residual).max() < TOLERANCE * np.abs(force).max():
            model.model.afterSolveStep(True)
            return u, pull, np.array(model.largest), iteration
        tangent = model.tangent()[free][:, free]
        change = splu(bmat([[tangent, -loaded], [-loaded.T, None]]).tocsc()).solve(np.append(-residual, off))
        u[free] += change[:-2]
        pull = pull + change[-2:]
    return None


if __name__ == "__main__":
    solve(Path(sys.argv[1]))
