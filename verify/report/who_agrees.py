"""Codes of others on scenes that all of them know, as runs of the day show it: a table for the documentation."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import date
from math import nan
from pathlib import Path

import numpy as np

from verify.checks.between_codes import CODE_TOLERANCE
from verify.checks.proof import SEARCHING, sampled
from verify.diagnosis.classify import diagnose
from verify.diagnosis.on_curve import Reference
from verify.methods import peers
from verify.pages.table import Column, Table
from verify.pages.text import percent
from verify.result import run_seconds
from verify.runs.jobs import Job, Outcome
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.studies import frame
from verify.version import __version__

#: The only criterion of fedoo, which MOOSE has as well.
POWER = ("interface.criterion=power", "interface.exponent=2", "interface.onset=quadratic")
#: Scenes, with what a code means by them: a closed gap of most is as stiff as the bond.
AGREED_ON = (
    ("dcb-czm1-linear", ()),
    ("dcb-czm1-linear", ("interface.penalty=1e3",)),
    ("enf-as4peek", POWER),
    ("mmb50-as4peek", (*POWER, "load.opening=8")),
)
COLUMNS = (
    Column("scene", "scene", once=True),
    Column("code", "code"),
    Column("curve", "curve off", percent),
    Column("peak", "peak off", percent),
    Column("verdict", "verdict"),
    Column("seconds", "seconds"),
    Column("command", "again by"),
)
HEAD = """# Who agrees

Codes of others on scenes of this repository, run by `debond peers report` on {day} with debond {version}: {codes}.
The distance of a curve is the relative L2 distance to NURBS on the scene's own mesh; beyond {tolerance:.1%} a
cause is sought. Times are those of the day.

"""


@dataclass(frozen=True)
class Row:
    """One code on one scene; NaN where there is no number."""

    scene: str
    code: str
    curve: float
    peak: float
    verdict: str
    seconds: float
    command: str


def who_agrees(names: Sequence[str], out: Path) -> Path:
    """Run the scenes by these codes into ``out``, and write who-agrees.md and .csv there."""
    rows: list[Row] = []
    for source, given in AGREED_ON:
        scene = load_scene(source, given)
        folder = out / "-".join([source, *given]).replace("=", "-")
        methods = (SEARCHING, *names)
        plan = [Job(source, scene, method, method, given, fields=False) for method in methods]
        outcomes = frame.run(plan, folder)
        rows += _rows(scene, [outcomes[job] for job in plan], folder)
    found = Table(COLUMNS, [vars(row) for row in rows], "Who agrees")
    found.csv(out / "who-agrees.csv")
    codes = ", ".join(peers.named(name).version for name in names)
    page = out / "who-agrees.md"
    page.write_text(
        HEAD.format(day=date.today(), version=__version__, codes=codes, tolerance=CODE_TOLERANCE)
        + found.markdown()
        + "\n"
    )
    return page


def _rows(scene: Scene, outcomes: Sequence[Outcome], out: Path) -> Iterator[Row]:
    """A row for every code that takes the scene, or should have."""
    right = outcomes[0].result
    for one in outcomes[1:]:
        name, result, curve, peak = one.job.variant, one.result, nan, nan
        if result is None and not one.failed:  # not made for it
            continue
        said = one.left_out if result is None else result.status
        if result is not None and right is not None and result.load.size > 1:
            given, (d, P) = (result.opening, result.load), (np.asarray(column) for column in sampled(right))
            curve, peak = Reference((d, P)).error(given), abs(given[1].max() / P.max() - 1.0)
            why = diagnose(name, given, (d, P), scene, CODE_TOLERANCE, out) if curve > CODE_TOLERANCE else None
            said = why.sentence.partition(": ")[2] if why is not None else "agrees"
            said += "" if result.complete else f"; {result.status}"
        words = ["debond", "verify", one.job.source, *(w for key in one.job.overrides for w in ("--set", key))]
        where = ", ".join([one.job.source, *one.job.overrides])
        seconds = run_seconds(result) if result is not None else nan
        yield Row(where, name, curve, peak, said, seconds, shlex.join([*words, "--peers", name]))
