"""The folder of a run: its contract with other people's scripts, and what survives when a run does not."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

from verify.methods import dolfinx
from verify.methods import solve as methods
from verify.methods.solve import prepare
from verify.result import CURVE_COLUMNS, Result, Snapshot, steps_from_rows
from verify.runs import environment
from verify.runs import run as run_of
from verify.runs.folder import CurveWriter, damage, read_columns, read_result, write_json
from verify.runs.run import Keep, run
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.support.timing import Stopwatch

HEADER = "opening,load,crack_length,stored_energy,dissipated_energy,external_work,newton_iterations"
RESULT_KEYS = {
    "scene", "method", "dofs", "elements", "steps", "newton_iterations", "rejected_steps", "peak_load", "peak_opening",
    "seconds", "peak_memory_mb", "effects", "checks", "versions", "machine", "threads", "status", "ending", "condition",
    "process_zone", "matched_interface", "decided", "neglected", "nonzeros", "jit_seconds",
    "counted_steps", "interpolated_rows", "sha256",
}  # fmt: skip
SHORT = ("load.opening=1.0", "discretization.dofs=800")
SECONDS_KEYS = ["mesh", "basis", "assembly", "factor", "solve", "other", "total"]
PROJECT = Path(__file__).resolve().parents[3]


@pytest.fixture
def scene():
    return load_scene("dcb-czm1-linear")


def rows_to(opening: float, n: int = 5) -> list[dict[str, float]]:
    """An elastic run of stiffness 2: load = 2 opening."""
    return [
        {
            **dict.fromkeys(CURVE_COLUMNS, 0.0),
            "opening": d, "load": 2 * d, "crack_length": 4.0, "stored_energy": d * d, "external_work": d * d,
            "newton_iterations": 2.0 if d else 0.0, "tip_opening": 0.1 * d,
        }
        for d in np.linspace(0.0, opening, n + 1)
    ]  # fmt: skip


def stub(scene: Scene, method: str, on_step) -> Result:
    """A solver that needs no time."""
    rows = rows_to(scene.load.opening[-1])
    for row in rows:
        on_step(row)
    fields = {"s_q": np.arange(3.0), "gap_q": np.ones(3), "traction_q": np.ones(3), "damage_q": np.zeros(3)}
    grids = {"X_euvi": np.zeros((2, 3, 3, 2)), "u_euvi": np.ones((2, 3, 3, 2)), "stress_euv": np.ones((2, 3, 3))}
    snapshots = (Snapshot(1.0, 2.0, **fields, **grids), Snapshot(3.0, 6.0, **fields, **grids))
    seconds = Stopwatch().seconds()
    return Result(method, steps_from_rows(rows), dofs=1956, elements=222, snapshots=snapshots, seconds=seconds)


def failing(error: BaseException):
    """A solver that comes to opening 1 and then raises."""

    def solve(scene: Scene, method: str, on_step) -> Result:
        for row in rows_to(1.0):
            on_step(row)
        raise error

    return solve


def test_curve_csv_keeps_its_contract(scene, tmp_path):
    run(prepare(scene, "nurbs"), tmp_path, solver=stub)
    lines = (tmp_path / "curve.csv").read_text().splitlines()
    assert lines[0] == HEADER
    assert [float(cell) for cell in lines[1].split(",")] == [0.0] * 7
    assert len(lines) == 2 + 5
    assert float(lines[2].split(",")[0]) == float(np.linspace(0.0, 3.0, 6)[1])  # 17 digits: nothing is lost
    assert not (tmp_path / "fields.npz").exists(), "nobody has asked for them"


def test_curve_csv_of_a_bond_that_slides_has_j_and_the_mode_ratio(tmp_path):
    writer = CurveWriter(tmp_path)
    for d in (0.0, 1.0):
        writer(dict.fromkeys(CURVE_COLUMNS, d) | {"J_loads": 2.0 * d, "J_bond": 3.0 * d, "mode_ratio": 0.5})
    writer.close()
    lines = (tmp_path / "curve.csv").read_text().splitlines()
    assert lines == [f"{HEADER},J_loads,J_bond,mode_ratio", ",".join("0" * 10), "1,1,1,1,1,1,1,2,3,0.5"]


def test_the_middles_of_chosen_steps_are_in_the_curve_alone(tmp_path):
    """Evidence, steps and iterations are those of converged points; a file that lacks one row is damaged."""
    chosen, counted = ([*SHORT, *more] for more in ((), ("discretization.steps=20",)))
    for name, overrides in (("chosen", chosen), ("counted", counted)):
        result, _ = run(prepare(load_scene("dcb-czm1-linear", overrides), "nurbs"), tmp_path / name)
        about = json.loads((tmp_path / name / "result.json").read_text())
        curve, evidence = (read_columns(tmp_path / name / file) for file in ("curve.csv", "evidence.csv"))
        middles = curve["newton_iterations"][1:] == 0.0
        assert about["steps"] + 1 == len(evidence["load"]) == len(result.load) == np.sum(~middles) + 1
        assert about["interpolated_rows"] == np.sum(middles) == (about["steps"] if name == "chosen" else 0)
        assert np.array_equal(curve["load"][1:][~middles], evidence["load"][1:])
        assert about["newton_iterations"] == evidence["newton_iterations"].sum()
        open_ = [
            np.abs(one["external_work"] - one["stored_energy"] - one["dissipated_energy"]).max()
            for one in (curve, evidence)
        ]
        assert open_[0] <= 1.001 * open_[1] and about["counted_steps"] == ""
        assert damage(tmp_path / name, "result.json") == ""
    file = tmp_path / "chosen" / "curve.csv"
    file.write_text("".join(file.read_text().splitlines(keepends=True)[:-1]))
    assert damage(tmp_path / "chosen", "result.json") == "curve.csv"


def test_steps_that_cannot_be_chosen_are_counted_and_the_run_says_why(tmp_path):
    prepared = prepare(load_scene("dcb-czm2", ["discretization.dofs=280", "load.opening=0.1"]), "lagrange")
    assert prepared.counted.endswith("interface points share the process zone, and steps by accuracy take 8")
    run(prepared, tmp_path)
    about = json.loads((tmp_path / "result.json").read_text())
    assert about["counted_steps"] == prepared.counted and about["steps"] >= 150 and about["interpolated_rows"] == 0
    assert prepare(load_scene("dcb-czm2"), "beam").counted == "", "which never chooses any"


def test_result_json_keeps_its_contract(scene, tmp_path):
    run(prepare(scene, "nurbs"), tmp_path, solver=stub)
    about = json.loads((tmp_path / "result.json").read_text())
    assert set(about) == RESULT_KEYS
    assert list(about["seconds"]) == SECONDS_KEYS
    assert all(set(check) == {"value", "tolerance", "kind", "passed", "state"} for check in about["checks"].values())
    assert about["steps"] == 5 and about["newton_iterations"] == 10
    assert about["peak_load"] == 6.0 and about["peak_opening"] == 3.0
    assert about["status"] == "complete" and about["ending"] == "" and about["condition"] == 0.0
    assert about["scene"]["interface"]["strength"] == 4.0


def test_a_run_is_read_back_as_it_was(scene, tmp_path):
    def solver(scene: Scene, method: str, on_step) -> Result:
        return replace(stub(scene, method, on_step), ending="separated at opening 2.5", condition=3e7)

    written, checks = run(prepare(scene, "nurbs"), tmp_path, keep=Keep(fields=True), solver=solver)
    read = read_result(tmp_path)
    assert (read.ending, read.condition) == ("separated at opening 2.5", 3e7)
    assert next(check for check in checks if check.name == "completed").passed
    assert set(read.steps) == set(written.steps)
    assert all(np.array_equal(read.steps[name], written.steps[name]) for name in read.steps)
    assert [s.opening for s in read.snapshots] == [1.0, 3.0]
    assert np.array_equal(read.snapshots[1].u_euvi, written.snapshots[1].u_euvi)
    assert (read.method, read.dofs, read.elements, read.status) == ("nurbs", 1956, 222, "complete")


def test_a_path_that_stops_on_an_unresolved_zone_says_so(scene, tmp_path):
    def solver(scene: Scene, method: str, on_step) -> Result:
        return replace(stub(scene, method, on_step), status="stopped: Newton did not converge")

    assert run(prepare(scene, "nurbs"), tmp_path, solver=solver)[0].status == "stopped: Newton did not converge"
    coarse = load_scene("dcb-czm1-linear", ["interface.strength=40.0", "discretization.dofs=280"])
    status = run(prepare(coarse, "nurbs"), tmp_path, solver=solver)[0].status
    assert status.startswith("stopped: process zone 0.2") and status.endswith("; Newton did not converge")


def test_an_interrupt_is_recorded_and_passed_on(scene, tmp_path):
    with pytest.raises(KeyboardInterrupt):
        run(prepare(scene, "nurbs"), tmp_path, solver=failing(KeyboardInterrupt()))
    assert json.loads((tmp_path / "result.json").read_text())["status"] == "stopped: interrupted"
    assert len(read_columns(tmp_path / "curve.csv")["load"]) == 6


def test_json_has_no_nan_and_is_whole_or_absent(tmp_path):
    path = tmp_path / "a.json"
    write_json(path, {"a": float("nan"), "b": [np.float64(2.5), float("inf")], "c": np.bool_(True)})
    assert json.loads(path.read_text()) == {"a": None, "b": [2.5, None], "c": True}
    with pytest.raises(TypeError):
        write_json(path, {"a": object()})
    assert json.loads(path.read_text())["c"] is True
    assert [p.name for p in tmp_path.iterdir()] == ["a.json"]


def test_phases_add_up_to_the_whole(monkeypatch):
    """By a clock that goes on by one between any two looks at it."""
    monkeypatch.setattr("verify.support.timing.perf_counter", iter(range(100)).__next__)
    watch = Stopwatch()
    with watch.phase("mesh"):
        pass
    assert watch.seconds() == {"mesh": 1, "basis": 0, "assembly": 0, "factor": 0, "solve": 0, "other": 2, "total": 3}
    with watch.phase("basis"), watch.phase("compile"):
        pass
    with watch.phase("strange"):
        pass
    found = watch.seconds()
    assert watch.compile == 1 and (found["basis"], found["other"], found["total"]) == (3, 6, 10)
    whole = Stopwatch()
    with whole.phase("assembly"), whole.phase("factor"):
        pass
    nested = whole.seconds()
    assert (nested["assembly"], nested["factor"]) == (2, 1) and sum(nested.values()) == 2 * nested["total"]
    with whole.phase("solve"):
        assert whole.seconds()["other"] == 3
    with whole.phase("solve"):
        pass
    assert whole.seconds()["solve"] == 3


def test_the_time_of_a_run_is_not_that_of_importing_its_solver(monkeypatch):
    """A module that is slow to come, and a solver that has nothing to do."""
    solution = SimpleNamespace(rows=({"opening": 0.0, "load": 0.0},), status="complete", rejected_steps=0, snapshots=())

    class Slow(ModuleType):
        def __getattr__(self, name: str) -> Callable[..., SimpleNamespace]:
            if name != "solve_debonding":
                raise AttributeError(name)
            time.sleep(0.5)
            return lambda problem, **keys: solution

    monkeypatch.setitem(sys.modules, "fem_reference.solve", Slow("fem_reference.solve"))
    monkeypatch.setattr(dolfinx, "dolfinx_installed", lambda: True)
    assert methods.solve(load_scene("dcb-czm1"), "dolfinx").seconds["total"] < 0.4


# --- ranks


class Down(BaseException):
    """What stands in for the end of all ranks."""


@pytest.fixture
def taken_down(monkeypatch):
    """Reasons for which all ranks were ended."""
    reasons: list[str] = []

    def down(why: str) -> None:
        reasons.append(why)
        raise Down

    monkeypatch.setattr(run_of, "_take_down_all_ranks", down)
    return reasons


def unlucky(scene: Scene, method: str, on_step: Callable | None) -> Result:
    if on_step is not None:
        on_step({name: 1.0 for name in CURVE_COLUMNS})
    raise unlucky.error


@pytest.mark.parametrize("ranks", [1, 2, 3])
def test_an_error_is_told_before_other_ranks_are_taken_down(ranks, scene, tmp_path, taken_down, monkeypatch):
    """They would wait for this one; a run that is alone just ends."""
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", str(ranks))
    unlucky.error = RuntimeError("no luck")
    if ranks == 1:
        run(prepare(scene, "nurbs"), tmp_path, solver=unlucky)
    else:
        with pytest.raises(Down):
            run(prepare(scene, "nurbs"), tmp_path, solver=unlucky)
    status = json.loads((tmp_path / "result.json").read_text())["status"]
    assert status.startswith("stopped: RuntimeError: no luck (an error in the program")
    assert taken_down == ([] if ranks == 1 else [status.removeprefix("stopped: ")])
    assert "no luck" in (tmp_path / "error.log").read_text() and len(read_columns(tmp_path / "curve.csv")["load"]) == 1


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_full_disk_ends_the_other_ranks_and_says_so_itself(ranks, scene, tmp_path, taken_down, monkeypatch):
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", str(ranks))
    unlucky.error = OSError(errno.ENOSPC, "no room")
    with pytest.raises(OSError if ranks == 1 else Down):
        run(prepare(scene, "nurbs"), tmp_path, solver=unlucky)
    assert len(taken_down) == ranks - 1 and not (tmp_path / "error.log").exists()


def test_other_ranks_compute_and_write_nothing(scene, tmp_path, taken_down, monkeypatch):
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "2")
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", "1")
    whole = Result("nurbs", steps_from_rows([{name: 1.0 for name in CURVE_COLUMNS}]))
    assert run(prepare(scene, "nurbs"), tmp_path / "out", solver=lambda *given: whole) == (whole, ())
    unlucky.error = RuntimeError("no luck")
    with pytest.raises(Down):
        run(prepare(scene, "nurbs"), tmp_path / "out", solver=unlucky)
    assert taken_down == ["RuntimeError: no luck"] and not (tmp_path / "out").exists()


def test_taken_down_is_at_once_and_with_a_reason():
    """Without what a program does at its end, where MPI would wait for the others."""
    code = (
        "import atexit; from verify.runs.run import _take_down_all_ranks\n"
        "atexit.register(print, 'late'); print('early'); _take_down_all_ranks('no luck'); print('on')"
    )
    environment = os.environ | {"PYTHONPATH": str(PROJECT), "OMPI_COMM_WORLD_RANK": "3"}
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, timeout=60)
    assert (ended.returncode, ended.stdout) == (1, "early\n") and "rank 3: no luck" in ended.stderr


@pytest.mark.parametrize(
    ("variables", "found"),
    [
        ({}, (0, 1)),
        ({"OMPI_COMM_WORLD_RANK": "2", "OMPI_COMM_WORLD_SIZE": "4"}, (2, 4)),
        ({"PMI_RANK": "1", "PMI_SIZE": "8"}, (1, 8)),
        ({"PMIX_RANK": "3"}, (3, 1)),
        ({"PMI_RANK": "none", "PMI_SIZE": ""}, (0, 1)),
    ],
)
def test_ranks_are_those_that_mpirun_tells(variables, found, monkeypatch):
    for name in ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK", "OMPI_COMM_WORLD_SIZE", "PMI_SIZE"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert (environment.mpi_rank(), environment.mpi_size()) == found


def test_threads_are_those_that_are_asked_for(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    assert environment.threads() == 3 and environment.environment()["threads a run"] == "3"
    monkeypatch.delenv("OMP_NUM_THREADS")
    assert environment.threads() == os.cpu_count() and environment.environment()["threads a run"] == "as many as cores"


def test_a_package_that_is_not_installed_has_no_version():
    assert environment.package_version("no-such-package-at-all") == ""
    assert "numpy" in environment.versions() and "no-such-package-at-all" not in environment.versions()


def test_what_was_done_before_an_error_is_the_result(scene, tmp_path):
    """Of a solver that tells all its steps in one and the same row."""

    def solver(scene: Scene, method: str, on_step: Callable) -> Result:
        row = dict.fromkeys(CURVE_COLUMNS, 0.0)
        for i in range(4):
            on_step(row)
            row["opening"], row["load"] = i + 1.0, [2.0, 3.0, 1.0, 9.0][i]
        raise ArithmeticError("no luck")

    result, _ = run(prepare(scene, "nurbs"), tmp_path, solver=solver)
    assert result.opening.tolist() == [0.0, 1.0, 2.0, 3.0] and result.load.tolist() == [0.0, 2.0, 3.0, 1.0]
    written = json.loads((tmp_path / "result.json").read_text())
    assert (written["steps"], written["peak_load"], written["peak_opening"]) == (3, 3.0, 2.0)
    assert "ArithmeticError: no luck" in written["status"]
