"""The shapes that a verification is made of: runs, checks, and both together for one scene."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from verify.result import Result
    from verify.scene import Scene

Kind = Literal["exact", "analytical", "cross-code", "regression"]


@dataclass(frozen=True)
class Check:
    """One number held against one tolerance.

    ``kind`` says what stands behind it: ``exact`` (an identity), ``analytical`` (a closed form or beam solution),
    ``cross-code`` (another code or a published value), ``regression`` (this code, earlier).
    """

    name: str  # short and stable, e.g. "j-integral"
    subject: str  # the run it judges, e.g. "nurbs" or "nurbs / dolfinx"
    value: float
    tolerance: float
    kind: Kind
    meaning: str  # one sentence for the reader of the report

    @property
    def passed(self) -> bool:
        return bool(abs(self.value) <= self.tolerance)  # NaN fails


@dataclass(frozen=True)
class Run:
    """One method on one scene: a result, or the reason why there is none."""

    label: str  # "NURBS p=3, 1952 dofs"
    method: str
    result: Result | None
    left_out: str = ""  # "not run: DOLFINx is not installed"
    folder: str = ""  # relative to the report
    command: str = ""  # repeats this run
    scene: Scene | None = None  # as this run had it; that of the report where left out
    key: str = ""  # hash of what the result rests on (`verify.fingerprint`)

    @property
    def name(self) -> str:
        """What checks call it, e.g. "nurbs-978": the last part of its folder."""
        return self.folder.rpartition("/")[2] or self.method


@dataclass(frozen=True)
class SceneReport:
    """Everything known about one scene; ``remarks`` say what is not judged, and why."""

    scene: Scene
    runs: tuple[Run, ...]
    checks: tuple[Check, ...]
    remarks: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        return all(check.passed for check in self.checks)

    def judged(self, check: Check) -> tuple[Run, ...]:
        """The runs that a check is about, the one that it judges first; none for what is no run of this scene."""
        named = {run.name: run for run in self.runs}
        return tuple(named[name] for name in check.subject.split(" / ") if name in named)
