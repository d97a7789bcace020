"""The script for Abaqus's own Python, with a database that stands in for that of Abaqus."""

import subprocess
import sys

import numpy as np

from verify.cli import main
from verify.curves.read import Reading, read_curve

ODB_ACCESS = """
class Thing:
    def __init__(self, **values):
        self.__dict__.update(values)

def region(scale):
    data = {"U2": [(t, scale * t) for t in (0.0, 0.5, 1.0)], "RF2": [(t, 2.0 * scale * t) for t in (0.0, 0.5, 1.0)]}
    return Thing(historyOutputs={name: Thing(data=tuple(rows)) for name, rows in data.items()})

def openOdb(path, readOnly):
    assert path == "job.odb" and readOnly
    regions = {"Node ASSEMBLY.%d" % NODE: region(0.1), "Node ASSEMBLY.1": region(9.0)}
    later = {"Node ASSEMBLY.%d" % NODE: region(0.3)}
    steps = {"leg-1": Thing(name="leg-1", historyRegions=regions), "leg-2": Thing(name="leg-2", historyRegions=later)}
    return Thing(steps=steps, close=lambda: None)
"""


def test_the_curve_comes_from_the_node_of_the_loaded_face(tmp_path, monkeypatch):
    assert main(["export", "dcb-czm1", "--format", "abaqus", "--elements", "20", "--out", str(tmp_path)]) == 0
    script, job = (tmp_path / "history.py").read_text(), (tmp_path / "dcb-czm1.inp").read_text()
    node = next(line for line in script.splitlines() if line.startswith("NODE"))
    assert f"NSET=upper_loaded_mean\n{node.split()[-1]},\n" in job and "the set upper_loaded_mean" in script
    (tmp_path / "odbAccess.py").write_text(f"{node}\n{ODB_ACCESS}")
    words = [sys.executable, "history.py", "job.odb"]
    subprocess.run(words, cwd=tmp_path, check=True, env={"PYTHONPATH": str(tmp_path)})
    d, P = read_curve(tmp_path / "history.csv", Reading("U2", "RF2"))
    assert np.allclose(d, [0.0, 0.05, 0.1, 0.15, 0.3]) and np.allclose(P, 2.0 * d)
