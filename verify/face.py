"""Public names of `verify` that spare a Python user what the commands do besides: loading, naming, folders."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from verify import report
from verify.checks.foreign_curves import joined
from verify.curves import compare as curves
from verify.curves.compare import Comparison
from verify.curves.read import Reading
from verify.methods.method import OnStep
from verify.methods.solve import prepare
from verify.report import Findings
from verify.result import Result
from verify.runs.environment import environment
from verify.runs.jobs import Job, Outcome
from verify.runs.run import Keep, run
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.studies.one_scene import scene_report
from verify.testing import CurveLike, points
from verify.verification import Subjects, verify


def compare(
    a: CurveLike,
    b: CurveLike,
    *,
    begin: float | None = None,
    end: float | None = None,
    programme: Sequence[float] | None = None,
    readings: tuple[Reading | None, Reading | None] = (None, None),
) -> Comparison:
    """Hold a load-opening curve A against a curve B.

    Parameters
    ----------
    a, b : results, pairs of arrays, tables, text files or folders of runs, as for `verify.testing.assert_curves_close`
    begin, end : openings between which they are compared; default: 0 and the last one of B
    programme : the openings at which the load turns, and the last one; default: those at which B unloads
    readings : which columns of A and of B are opening and load, and what they are multiplied by

    Raises
    ------
    ValueError, TypeError : no curve, or nothing in common.
    """
    names = str(getattr(a, "method", "")) or "A", str(getattr(b, "method", "")) or "B"
    names = names if names[0] != names[1] else ("A", "B")
    both = points(names[0], a, readings[0]), points(names[1], b, readings[1])
    return curves.compare(*both, end, names, begin, programme)


def verify_scenes(
    scenes: Sequence[str | Path], out: str | Path = "debond-report", *, jobs: int | None = None, full: bool = False
) -> bool:
    """Every method on every scene, each run in a process of its own, all checks, one report; as ``debond verify``.

    Parameters
    ----------
    scenes : packaged names or scene files
    out : folder of report.html, verdict.json and the runs; what is there already is not run again
    jobs : runs at a time; default: one a core
    full : finer meshes and the studies of ``--full`` as well

    Returns
    -------
    bool : whether no check is broken.
    """
    loaded = [(str(name), load_scene(name)) for name in scenes]
    return verify(Subjects(loaded, full), Path(out), jobs or os.cpu_count() or 1)


def write_report(scene: Scene, results: Sequence[Result] | Mapping[str, Result], out: str | Path) -> Path:
    """The report page of results at hand: their curves, fields and checks, each alone and against the others.

    Parameters
    ----------
    results : runs on the scene, of different methods, or by names such as "nurbs-978" where methods repeat
    out : folder of report.html, with a folder a run as ``debond solve`` writes it

    Returns
    -------
    Path : the page.

    Raises
    ------
    ModuleNotFoundError : matplotlib or Jinja is not installed; ``pip install 'debond[report]'``.
    """
    out, outcomes = Path(out), []
    for name, result in (results if isinstance(results, Mapping) else {one.method: one for one in results}).items():
        job = Job(scene.name, scene, result.method, name)
        run(prepare(scene, result.method), job.folder(out), Keep(fields=True), solver=partial(_replayed, result))
        outcomes.append(Outcome(job, result))
    judged = scene_report(scene, outcomes, out)
    judged = replace(judged, runs=tuple(replace(one, command="", key="") for one in judged.runs))
    page = out / "report.html"
    report.write(Findings((joined(judged, (), out),), environment()), page)
    return page


def _replayed(result: Result, scene: Scene, method: str, on_step: OnStep | None) -> Result:
    """A solver that has solved already: it reports the rows of its result."""
    for row in zip(*result.steps.values(), strict=True):
        if on_step is not None:
            on_step(dict(zip(result.steps, map(float, row), strict=True)))
    return result
