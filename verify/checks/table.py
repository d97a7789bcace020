"""Checks as lines of text."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from verify.verdict import Check, SceneReport, worst_of_each


def check_table(checks: Iterable[Check], scene: str = "") -> list[str]:
    """One line per check: state, kind, name, subject, value, tolerance, and why it judges nothing if it does not."""
    lines = []
    for c in checks:
        line = f"{c.state:11} {scene:{18 if scene else 0}} {c.kind:11} {c.name:16} {c.subject:20} {c.value:9.2e} "
        lines.append(f"{line}(<= {c.tolerance:.1e}){f': {c.unresolved}' if c.unresolved else ''}")
    return lines


def overview(reports: Iterable[SceneReport]) -> list[str]:
    """A table per scene with a line per check and a column per run; ! marks a broken check, ? an unresolved one, - what
    a curve does not contain."""
    lines: list[str] = []
    for report in reports:
        names = dict.fromkeys((check.name, check.kind) for check in report.checks)
        widths = {run: max(12, len(run) + 2) for run in dict.fromkeys(_run(check) for check in report.checks)}
        longest = max((len(name) for name, _ in names), default=0)
        lines.append(f"{report.scene.name:{longest + 13}}" + _row(widths, {run: run for run in widths}))
        for name, kind in names:
            # The cell of several checks shows the one that uses the largest part of its tolerance.
            found = sorted((check for check in report.checks if check.name == name), key=_used)
            cells = {_run(check): _cell(check) for check in found}
            lines.append(f"  {name:{longest}} {kind:10}" + _row(widths, cells))
        told = (f"  {run.method}: {run.left_out}" for run in report.runs if run.result is None)
        lines += dict.fromkeys(told)  # runs of one method for one reason
        lines += [*(f"  {remark}" for remark in report.remarks), ""]
    return lines


def _row(widths: Mapping[str, int], cells: Mapping[str, str]) -> str:
    """The cells of the runs, each as wide as its column."""
    return "".join(f"{cells.get(run, ''):>{width}}" for run, width in widths.items())


def not_held(checks: Sequence[tuple[str, Check]]) -> list[str]:
    """A line for each check of a run that does not hold, with the partner that it is farthest from."""
    return [
        line + f" and {more} more of its partners" * bool(more)
        for scene, check, more in worst_of_each(checks)
        for line in check_table([check], scene)
    ]


def _run(check: Check) -> str:
    """The run that a check judges: the first of a pair."""
    return check.subject.split(" / ")[0]


#: Marks of the states in a table, from good to bad: a cell for several checks shows the worst.
STATE_MARKS = {"not covered": "-", "holds": " ", "unresolved": "?", "broken": "!"}


def _used(check: Check) -> tuple[int, float]:
    """Part of its tolerance that a check uses: orders checks from well within to far beyond it."""
    return list(STATE_MARKS).index(check.state), abs(check.value) / check.tolerance if check.tolerance else 0.0


def _cell(check: Check) -> str:
    return f"{abs(check.value):.1e}{STATE_MARKS[check.state]}" if check.covered else STATE_MARKS[check.state]
