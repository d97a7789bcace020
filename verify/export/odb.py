"""A script for Abaqus's own Python, 2.7 or 3, that writes the curve of an exported scene from the output database."""

from __future__ import annotations

from pathlib import Path

from verify.export.references import Reference

SCRIPT = '''\
"""Write history.csv, U2 and RF2 of node {node}, which stands for the set {name}: abaqus python history.py JOB.odb"""
import csv
import sys

from odbAccess import openOdb

NODE = {node}

odb = openOdb(sys.argv[-1], readOnly=True)
rows = []
for step in odb.steps.values():
    found = [region for name, region in step.historyRegions.items() if name.endswith(".%d" % NODE)]
    if not found:
        sys.exit("no history of the node %d in the step %s: is this the job of the exported file?" % (NODE, step.name))
    moved, borne = (dict(found[0].historyOutputs[name].data) for name in ("U2", "RF2"))
    for time in sorted(set(moved) & set(borne)):
        if not rows or time > 0.0:  # a step begins where the one before has ended
            rows.append((step.name, time, moved[time], borne[time]))
odb.close()
with open("history.csv", "w") as stream:
    writer = csv.writer(stream, lineterminator="\\n")
    writer.writerow(("step", "time", "U2", "RF2"))
    writer.writerows(rows)
print("written: history.csv, %d rows" % len(rows))
'''


def write_odb_script(loaded: Reference, path: Path) -> None:
    """Write the script for the reference node that bears the load."""
    path.write_text(SCRIPT.format(name=loaded.name, node=loaded.node), encoding="utf-8")
