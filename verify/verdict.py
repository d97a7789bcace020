"""The shapes that a verification is made of: runs, checks, and both together for one scene."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, get_args

if TYPE_CHECKING:
    from verify.result import Result
    from verify.scene.schema import Scene

Kind = Literal["exact", "analytical", "certified", "cross-code", "regression"]

#: ``holds``: within the tolerance. ``broken``: a fault of the code that is judged. ``unresolved``: the check cannot
#: judge, because a mesh or the reference is too coarse for its tolerance. ``not covered``: the curve of another code
#: does not contain what the check is about.
State = Literal["holds", "broken", "unresolved", "not covered"]


@dataclass(frozen=True)
class Check:
    """One number held against one tolerance.

    ``kind`` says what stands behind it: ``exact`` (an identity), ``analytical`` (a closed form or beam solution),
    ``certified`` (a value of two codes with its uncertainty), ``cross-code`` (another code or a published value),
    ``regression`` (this code, earlier).
    """

    name: str  # short and stable, e.g. "j-integral"
    subject: str  # the run it judges, e.g. "nurbs" or "nurbs / dolfinx"
    value: float
    tolerance: float
    kind: Kind
    meaning: str  # one sentence for the reader of the report
    uncertainty: float = 0.0  # discretisation error of the reference, relative as the value is
    unresolved: str = ""  # why the check cannot judge, and what would resolve it; empty where it can
    covered: bool = True  # whether the curve contains what the check is about
    at: float | None = None  # the opening of the point that it is about

    @property
    def state(self) -> State:
        if self.unresolved:
            return "unresolved" if self.covered else "not covered"
        return "holds" if abs(self.value) <= self.tolerance else "broken"  # NaN is broken

    @property
    def passed(self) -> bool:
        return self.state == "holds"


class Checks(tuple[Check, ...]):
    """The checks of one run; a table in a notebook."""

    __slots__ = ()

    @property
    def fault(self) -> str:
        """The broken checks with value and tolerance; empty where there is none."""
        broken = [f"{c.name} {abs(c.value):.2g} of {c.tolerance:.2g}" for c in self if c.state == "broken"]
        return f"broken: {', '.join(broken)}" if broken else ""

    def _repr_html_(self) -> str:
        from iga.notebook import table

        rows = [(c.name, f"{abs(c.value):.1e}", f"{c.tolerance:.1e}", c.state, c.unresolved or c.meaning) for c in self]
        return table(("check", "value", "tolerance", "state", ""), rows)


def of_state(check: Check) -> dict[str, Any]:
    """What JSON files say of the state of a check; ``unresolved`` and ``uncertainty`` only where there is one."""
    said: dict[str, Any] = {"passed": check.passed, "state": check.state}
    if check.unresolved:
        said["unresolved"] = check.unresolved
    if check.uncertainty:
        said["uncertainty"] = check.uncertainty
    return said


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
    key: str = ""  # hash of what the result rests on (`verify.runs.fingerprint`)
    missing: bool = False  # left out because this machine lacks the method

    @property
    def name(self) -> str:
        """What checks call it, e.g. "nurbs-978": the last part of its folder."""
        return self.folder.rpartition("/")[2] or self.method


@dataclass(frozen=True)
class Explanation:
    """A cause of the deviation of a curve: by how much, and the curve error with it undone and as it is.

    ``words`` name it with its amount, whose ``unit`` is "part" (relative), "factor", "switch", a count or a quantity;
    ``fitted``: whether the amount was.
    """

    name: str
    words: str
    amount: float
    unit: str
    error_with: float
    error_without: float
    fitted: bool = True


@dataclass(frozen=True)
class Diagnosis:
    """What explains the deviation of a curve: ``causes`` best first, whether the first one does, and the names of those
    that the curve cannot tell from it."""

    curve: str
    causes: tuple[Explanation, ...]
    explained: bool
    alike: tuple[str, ...] = ()
    sentence: str = ""


@dataclass(frozen=True)
class SceneReport:
    """Everything known about one scene; ``remarks`` say what is not judged, and why."""

    scene: Scene
    runs: tuple[Run, ...]
    checks: tuple[Check, ...]
    remarks: tuple[str, ...] = ()
    diagnoses: tuple[Diagnosis, ...] = ()
    verdicts: tuple[str, ...] = ()  # a sentence for each curve of another code

    def judged(self, check: Check) -> tuple[Run, ...]:
        """The runs that a check is about, the one that it judges first; none for what is no run of this scene."""
        named = {run.name: run for run in self.runs}
        return tuple(named[name] for name in check.subject.split(" / ") if name in named)


def worst_of_each(checks: Iterable[tuple[str, Check]]) -> list[tuple[str, Check, int]]:
    """Checks, each with its scene, that do not hold: of those that differ in their partner alone the worst one, with
    the number of the others."""
    found: dict[tuple[str, ...], list[Check]] = {}
    for scene, check in checks:
        if not check.passed:
            found.setdefault((scene, check.name, check.subject.split(" / ")[0], check.state), []).append(check)
    return [
        (scene, max(same, key=lambda one: abs(one.value) / max(one.tolerance, 1e-300)), len(same) - 1)
        for (scene, *_), same in found.items()
    ]


@dataclass(frozen=True)
class Counts:
    """How many checks there are, and how many in each state."""

    total: int
    held: int
    broken: int
    unresolved: int
    not_covered: int = 0


def counted(checks: Iterable[Check]) -> Counts:
    """The checks by their state."""
    states = [check.state for check in checks]
    return Counts(len(states), *(states.count(state) for state in get_args(State)))
