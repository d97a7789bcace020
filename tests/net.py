"""The net: curves, evidence and verdicts of all packaged scenes by every method, against those that were recorded.

    ./debond verify $(./debond scenes | cut -d' ' -f1) --out all
    ./debond exec python tests/net.py all               # what has changed, a line each; exit code 1 if anything has
    ./debond exec python tests/net.py all --record      # the recorded ones anew

A curve of as many steps as before is held to `SAME` step by step; one whose steps end elsewhere to `ON_THE_GRAPH` of
the graph of the other, and is listed. The peak is held to `PEAK`, the end of each column of evidence likewise.
"""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from verify.curves.curve import point_distances

RECORDED = Path(__file__).parent / "recorded"
SAME, ON_THE_GRAPH, PEAK = 1e-9, 1e-4, 1e-6
DIGITS = 12


def taken(report: Path) -> dict[str, dict[str, Any]]:
    """Of each scene of a report: its runs, with curve and the last row of all columns, and the states of its checks."""
    verdict = json.loads((report / "verdict.json").read_text())
    scenes: dict[str, dict[str, Any]] = {}
    for run in verdict["runs"]:
        scene, name = run["folder"].split("/", 1)
        if "/" not in name:
            found = scenes.setdefault(scene, {"runs": {}, "checks": {}})
            found["runs"][name] = {"status": run["status"], **_numbers(report / run["folder"])}
    for check in verdict["checks"]:
        if check["scene"] in scenes:
            scenes[check["scene"]]["checks"][f"{check['subject']}: {check['name']}"] = check["state"]
    return scenes


def _numbers(folder: Path) -> dict[str, Any]:
    columns: dict[str, list[float]] = {}
    for name in ("curve.csv", "evidence.csv"):
        if (folder / name).is_file():
            with (folder / name).open() as file:
                header, *rows = csv.reader(file)
            for n, key in enumerate(header):
                columns[key] = [_short(row[n]) for row in rows]
    ends = {name: values[-1] for name, values in columns.items() if name != "newton_iterations"}
    return {"opening": columns["opening"], "load": columns["load"], "ends": ends}


def _short(text: str) -> float:
    return float(f"{float(text or 'nan'):.{DIGITS}g}")


def differences(now: dict[str, Any], before: dict[str, Any], scene: str) -> list[str]:
    """A line for everything of a scene that is not as it was."""
    lines = [
        f"{scene} {what}: {before[kind].get(what, 'new')} before, {now[kind].get(what, 'gone')} now"
        for kind in ("checks",)
        for what in sorted({*now[kind], *before[kind]})
        if now[kind].get(what) != before[kind].get(what)
    ]
    for name in sorted({*now["runs"], *before["runs"]}):
        if name not in now["runs"] or name not in before["runs"]:
            lines.append(f"{scene}/{name}: {'gone' if name in before['runs'] else 'new'}")
        else:
            lines += [f"{scene}/{name}: {line}" for line in _of_run(now["runs"][name], before["runs"][name])]
    return lines


def _of_run(now: dict[str, Any], before: dict[str, Any]) -> list[str]:
    if now["status"] != before["status"]:
        return [f"{before['status']} before, {now['status']} now"]
    curves = [np.array([run["opening"], run["load"]]) for run in (now, before)]
    size = np.max(np.abs(curves[1]), axis=1)
    same = curves[0].shape == curves[1].shape
    if same:
        off, bound = float(np.max(np.abs(curves[0] - curves[1]) / size[:, None])), SAME
    else:
        distances = point_distances(tuple(curves[0]), tuple(curves[1]), (size[0], size[1]))
        off, bound = float(np.max(distances)), ON_THE_GRAPH
    lines = [] if same else [f"{curves[1].shape[1]} steps before, {curves[0].shape[1]} now, {off:.1e} off"]
    if same and off > bound or off > ON_THE_GRAPH:
        lines.append(f"the curve is {off:.1e} off")
    peaks = [float(np.max(curve[1])) for curve in curves]
    if abs(peaks[0] - peaks[1]) > PEAK * abs(peaks[1]):
        lines.append(f"peak {peaks[1]:.9g} before, {peaks[0]:.9g} now")
    if same:
        for column in sorted({*now["ends"], *before["ends"]}):
            mine, other = (run["ends"].get(column, np.nan) for run in (now, before))
            if not np.isclose(mine, other, PEAK, PEAK * _scale(column, before), equal_nan=True):
                lines.append(f"{column} at the end {other:.9g} before, {mine:.9g} now")
    return lines


def _scale(column: str, run: dict[str, Any]) -> float:
    """What a column is compared with that may end at nothing: the work of the run, or its largest load."""
    work, load = abs(run["ends"]["external_work"]), float(np.max(np.abs(run["load"])))
    if column.endswith("_energy") or column == "external_work":
        return work
    return load if column.startswith(("support", "reaction", "interface_", "arm_force", "load")) else work / load


def main(folder: str, record: str = "") -> int:
    found = taken(Path(folder))
    if record:
        RECORDED.mkdir(exist_ok=True)
        for name, scene in found.items():
            (RECORDED / f"{name}.json").write_text(
                json.dumps(scene, separators=(",", ":")).replace('"runs"', '\n"runs"') + "\n"
            )
        return 0
    lines = [] if RECORDED.is_dir() else [f"nothing is recorded in {RECORDED}"]
    for file in sorted(RECORDED.glob("*.json")):
        known = json.loads(file.read_text())
        lines += differences(found[file.stem], known, file.stem) if file.stem in found else [f"{file.stem}: gone"]
    print("\n".join(lines) or "as recorded")
    return bool(lines)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
