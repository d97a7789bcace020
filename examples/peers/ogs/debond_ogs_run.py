"""OpenGeoSys on the project file of this folder, step by step; needs nothing of debond."""

import json
import sys

import numpy as np
import ogs.OGSMesh  # noqa: F401  the type of what a simulation returns
from ogs.OGSSimulator import OGSSimulation

if __name__ == "__main__":
    with open("known.json") as file:
        known = json.load(file)
    simulation = OGSSimulation(["ogs", "scene.prj", "-l", "error"])
    print("ready", flush=True)
    mesh = simulation.mesh("scene")
    while simulation.current_time() < simulation.end_time():
        if simulation.execute_time_step():
            sys.exit(f"step {simulation.current_time() + 1:g} has not converged")
        # nothing but the bond and the load holds the upper arm along y
        traction = np.array(mesh.data_array("fracture_stress_avg", "double")).reshape(-1, 2)[known["bond"] :, 1]
        part = simulation.current_time() / simulation.end_time()
        load = known["width"] * float(traction @ known["length"])
        print("row", json.dumps({"opening": part * known["opening"], "load": load}), flush=True)
