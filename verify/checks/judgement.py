"""The verdict of a verification: its checks, the gaps between them, and whether the caller allows these gaps."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from verify.verdict import Check, SceneReport, State, counted


@dataclass(frozen=True)
class Demands:
    """Conditions for a verification to pass, besides that no check is broken.

    Parameters
    ----------
    strict : no gap is allowed
    required : methods that must have run on every scene
    """

    strict: bool = False
    required: tuple[str, ...] = ()


NO_DEMANDS = Demands()


@dataclass(frozen=True)
class Gap:
    """A run whose method this machine lacks, or a check that judges nothing (``check`` is its name, else empty)."""

    scene: str
    subject: str
    check: str
    why: str
    state: State | None = None


@dataclass(frozen=True)
class Judgement:
    """The checks of a verification, each with its scene, and the gaps."""

    checks: tuple[tuple[str, Check], ...]
    gaps: tuple[Gap, ...]
    demands: Demands

    @property
    def lacking(self) -> tuple[Gap, ...]:
        """The gaps that the caller does not allow."""
        if self.demands.strict:
            return self.gaps
        return tuple(gap for gap in self.gaps if not gap.check and gap.subject in self.demands.required)

    @property
    def passed(self) -> bool:
        states = [check.state for _, check in self.checks]
        return bool(states) and "broken" not in states and not self.lacking

    def in_short(self) -> str:
        """The last line of a verification."""
        counts = counted(check for _, check in self.checks)
        broken = f", {counts.broken} broken" if counts.broken else "" if counts.total else ", and nothing is verified"
        gaps = "; not judged: " + "; ".join(_grouped(self.gaps)) if self.gaps else ""
        return f"{counts.held} of {counts.total} checks hold{broken}{gaps}"


def judged(reports: Sequence[SceneReport], demands: Demands) -> Judgement:
    """The judgement of all scenes."""
    checks = [(report.scene.name, check) for report in reports for check in report.checks]
    gaps = [
        Gap(report.scene.name, run.method, "", run.left_out.removeprefix("not run: "))
        for report in reports
        for run in report.runs
        if run.missing
    ]
    gaps += [gap_of(name, check) for name, check in checks if check.unresolved]
    return Judgement(tuple(checks), tuple(gaps), demands)


def gap_of(scene: str, check: Check) -> Gap:
    """What a check leaves open."""
    return Gap(scene, check.subject, check.name, check.unresolved, check.state)


def _grouped(gaps: Iterable[Gap]) -> list[str]:
    """Missing runs by method with their reason, checks that judge nothing by name and state."""
    scenes: dict[str, list[str]] = {}
    for gap in gaps:
        what = f"{gap.check} ({gap.state})" if gap.check else f"{gap.subject} ({gap.why})"
        scenes.setdefault(what, []).append(gap.scene)
    return [f"{what} on {', '.join(dict.fromkeys(names))}" for what, names in scenes.items()]
