"""PyFEM on one folder, step by step; needs nothing of debond."""

import json
import os
import sys

if __name__ == "__main__":
    import matplotlib

    matplotlib.use("Agg")
    import pyfem.solvers.Solver as solvers
    from pyfem.io.InputReader import InputReader
    from pyfem.solvers.NonlinearSolver import NonlinearSolver

    print("ready", flush=True)
    # It is imported there in a function by `exec`, which reaches no name since Python 3.13.
    solvers.NonlinearSolver = NonlinearSolver
    os.chdir(sys.argv[1])
    with open("known.json") as file:
        known = json.load(file)
    properties, data = InputReader(["pyfem", "scene.pro"])
    solver, step = solvers.Solver(properties, data), 0
    while data.active:
        solver.run(properties, data)
        step += 1
        load = known["width"] * sum(float(data.fint[data.dofs.getForType(n, "v")]) for n in known["upper"])
        row = {"opening": step * known["step"], "load": load, "newton_iterations": data.iiter}
        print("row", json.dumps(row), flush=True)
