"""fedoo on one folder: its elements, interface elements, law and Newton's method; needs nothing of debond.

With the name of a table as well: its law alone on the paths of the folder.
"""

import csv
import json
import sys
from pathlib import Path
from types import SimpleNamespace

import fedoo as fd
import numpy as np

#: Residual over the forces, Newton iterations of a step at most, and the smallest part of a step.
TOLERANCE, ITERATIONS, LEAST = 1e-6, 25, 2.0**-12


def law_of(numbers):
    """fedoo's bilinear law, the normal along the second axis."""
    return fd.constitutivelaw.CohesiveLaw(axis=1, tangent_mode="consistent", **numbers)


def bonded(X_nI, conn_ea, numbers):
    """Interface elements with a law."""
    return fd.Assembly.create(fd.weakform.InterfaceForce(law_of(numbers)), fd.Mesh(X_nI, conn_ea, "lin2interface"))


def tied(problem, patch, constant=0.0, time_func=None):
    """The weighted sum of displacements of a patch is ``constant``; the unknown of the largest weight is eliminated."""
    nodes, variables, weights = zip(*sorted(patch, key=lambda one: -abs(one[2])), strict=True)
    problem.bc.add(fd.MPC(np.c_[list(nodes)], list(variables), np.c_[list(weights)], np.array([-constant]), time_func))


def solve(folder):
    """Print a line for every step."""
    print("ready", flush=True)
    given = np.load(folder / "mesh.npz")
    told = json.loads((folder / "problem.json").read_text())
    fd.ModelingSpace("2Dplane")
    X_nI = given["X_nI"]
    parts = []
    for body, stiffness in enumerate(told["stiffness"]):
        conn_ea = given["conn_ea"][given["body_e"] == body]
        material = fd.constitutivelaw.ElasticAnisotropic(np.array(stiffness))
        mesh = fd.Mesh(X_nI, conn_ea, f"quad{conn_ea.shape[1]}")
        parts.append(fd.Assembly.create(fd.weakform.StressEquilibrium(material), mesh))
    parts += [bonded(X_nI, given[name], told[name]) for name in ("bond", "crack") if len(given[name])]
    problem = fd.problem.NonLinear(fd.Assembly.sum(*parts))
    turns = np.array([0.0, *told["opening"]])
    at = np.append(0.0, np.abs(np.diff(turns)).cumsum())
    largest = np.abs(turns).max()
    for nodes, component in told["held"]:
        problem.bc.add("Dirichlet", np.array(nodes), component, 0)
    for patch in told["resting"]:
        tied(problem, patch)
    for patch, part in told["loaded"]:
        tied(problem, patch, part * largest, lambda t: np.interp(t, at / at[-1], turns) / largest)
    pulled = np.array(told["pulled"])
    problem.set_nr_criterion("Force", tol=TOLERANCE, max_subiter=ITERATIONS)

    def row(now):
        force = now.get_ext_forces("DispY", include_mpc=False)[pulled].sum()
        opening = np.interp(now.time, at / at[-1], turns)
        print("row", json.dumps({"opening": float(opening), "load": told["scale"] * float(force)}), flush=True)

    dt = 1.0 / told["steps"]
    problem.nlsolve(dt=dt, dt_max=dt, dt_min=LEAST * dt, interval_output=dt, print_info=0, callback=row)


def tractions(folder, to):
    """Write the tractions of the law alone, step by step on every path of ``paths.csv``."""
    law = law_of(json.loads((folder / "fedoo.json").read_text()))
    point, before = SimpleNamespace(), None
    with (folder / "paths.csv").open() as file, to.open("w") as out:
        print("path,step,g,s,p,t", file=out)
        for row in csv.DictReader(file):
            if row["path"] != before:
                point.sv, before = {"DamageVariableIrreversible": 0}, row["path"]
            g, s = float(row["g"]), float(row["s"])
            law._update_damage(point, np.array([[s], [g]]))
            secant = law.get_secant_matrix(point)
            law.update_irreversible_damage(point)
            p, t = float(secant[1][1][0] * g), float(secant[0][0][0] * s)
            print(f"{row['path']},{row['step']},{g!r},{s!r},{p!r},{t!r}", file=out)


if __name__ == "__main__":
    tractions(*map(Path, sys.argv[1:])) if len(sys.argv) > 2 else solve(Path(sys.argv[1]))
