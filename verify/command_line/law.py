"""`debond law`: paths written, a law judged on them, and what is said of it."""

from __future__ import annotations

from pathlib import Path

from verify.checks.table import check_table
from verify.runs.folder import write_json
from verify.scene.schema import Scene
from verify.studies.law import record
from verify.studies.law.given.read import PathColumns
from verify.studies.law.judge import Judgement, worst_first
from verify.studies.law.study import BUILT_IN, Subject, judge_built_in, judge_given
from verify.studies.law.wording import sentences
from verify.support.refusal import Refusal
from verify.support.say import say, write_page
from verify.verdict import counted

#: Broken checks that are printed.
BROKEN_LINES = 12


def judged(of: Subject, given: str | None, columns: PathColumns, tolerance: float | None) -> tuple[Judgement, str]:
    """The verdict and the name of the law; without ``given`` that of the solvers.

    Raises
    ------
    Refusal : a file or function that gives no tractions, or options for one that is not there.
    """
    if given is not None:
        return judge_given(of, given, columns, tolerance), Path(given).name
    for option, value in (("--columns", columns.names), ("--scales", columns.scales), ("--tolerance", tolerance)):
        if value not in ({}, None):
            raise Refusal(f"{option}: is only for a law that --with names, got no --with")
    return judge_built_in(of), BUILT_IN


def write(found: Judgement, scene: Scene, law: str, out: Path) -> None:
    """Write law.json, and the page where matplotlib and Jinja are installed."""
    write_json(out / record.LAW_FILE, record.content(found, scene.name, law))
    write_page("verify.studies.law.page", found, scene, law, out / record.PAGE_FILE)
    print(f"written: {out}")


def report(found: Judgement, scene: Scene, law: str) -> None:
    """Print broken checks, defects, what was not judged, and a last line that counts."""
    broken = [check for check in worst_first(found.checks) if not check.passed]
    print("\n".join(check_table(broken[:BROKEN_LINES])), end="\n" if broken else "")
    if len(broken) > BROKEN_LINES:
        print(f"and {len(broken) - BROKEN_LINES} more")
    for sentence in sentences(found.defects):
        print(f"defect: {sentence}")
    for remark in found.remarks:
        say(remark)
    total = counted(found.checks)
    counts = f"{total.total} checks on {len(found.ways)} paths, {total.held} hold, {total.broken} broken"
    print(f"{law} on {scene.name}: {counts}")
