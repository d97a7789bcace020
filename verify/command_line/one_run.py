"""One run of a scene on the command line: progress, results, remarks."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from verify.support.say import say

if TYPE_CHECKING:
    from verify.methods.method import Prepared
    from verify.result import Result
    from verify.runs.run import Keep
    from verify.verdict import Check


def kept(options: argparse.Namespace) -> Keep:
    from verify.runs.run import Keep

    return Keep(options.fields, options.frames if options.fields else 0)


def with_progress(prepared: Prepared, folder: Path, keep: Keep, quiet: bool) -> tuple[Result, tuple[Check, ...]]:
    """Run with a progress bar over the programme."""
    from verify.runs.run import run
    from verify.support.progress import Progress

    scene = prepared.scene
    legs = [abs(b - a) for a, b in zip((0.0, *scene.load.opening), scene.load.opening, strict=False)]
    gone = before = 0.0
    with Progress(f"{scene.name} {prepared.method.name}", sum(legs), quiet) as progress:

        def advance(row: Mapping[str, float]) -> None:
            nonlocal gone, before
            gone, before = gone + abs(row["opening"] - before), row["opening"]
            progress.advance(gone, f"opening {row['opening']:.4g} load {row['load']:.4g}")

        return run(prepared, folder, keep, advance)


def print_result(result: Result, checks: Sequence[Check], folder: Path) -> None:
    from verify.checks.table import check_table

    peak = result.load.argmax() if result.load.size else None
    if peak is not None:
        print(f"peak load {result.load[peak]:.6g} at opening {result.opening[peak]:.6g}, {result.load.size - 1} steps")
    if result.seconds:
        print("seconds: " + ", ".join(f"{name} {value:.2f}" for name, value in result.seconds.items()))
    print("\n".join(check_table(checks)))
    if not result.complete:
        say(f"{result.method} {result.status}")
    print(f"{', '.join(filter(None, (result.status, result.ending)))}: {folder}")


def say_after(prepared: Prepared, result: Result, checks: Sequence[Check]) -> None:
    from verify.checks import neglected
    from verify.scene.schema import DEFAULT_STEPS

    for remark in neglected.warnings(prepared, result):
        say(remark)
    if result.counted_steps:
        say(f"discretization.steps: {DEFAULT_STEPS} {result.counted_steps}")
    wrong = broken(checks)
    if result.complete and wrong:
        why = "the mesh does not explain it, the run or the solver is at fault"
        say(f"{result.method}: broken: {', '.join(wrong)}; {why}")


def broken(checks: Sequence[Check]) -> list[str]:
    return [check.name for check in checks if check.state == "broken"]
