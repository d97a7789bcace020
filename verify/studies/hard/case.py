"""A hard case, its runs, and what its criteria find."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from iga.bases.names import BASES
from verify.result import Result
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.verdict import Check, Kind


@dataclass(frozen=True)
class Trial:
    """One run of a case: its name, which is that of its folder, its scene and its result."""

    name: str
    scene: Scene
    result: Result


@dataclass(frozen=True)
class Number:
    """A number that is reported without a tolerance."""

    name: str
    subject: str
    value: float
    meaning: str


Finding = Check | Number
Trials = Mapping[str, Trial]
Judge = Callable[[Trials], Iterator[Finding]]


def no_judge(trials: Trials) -> Iterator[Finding]:
    """The judge of a case that has only the criteria of every case."""
    yield from ()


@dataclass(frozen=True)
class Case:
    """A hard case.

    Parameters
    ----------
    hard : the difficulty, in one sentence
    scenes : makes the scenes of its runs, by their names
    judge : criteria of all runs together, in addition to those that every run has to meet (``criteria.common``)
    may_stop : runs may end before their programme does; ``judge`` decides about their end
    bases : bases for which the case is defined
    """

    name: str
    hard: str
    scenes: Callable[[], Mapping[str, Scene]]
    judge: Judge = no_judge
    may_stop: bool = False
    bases: tuple[str, ...] = tuple(BASES)


def judged_by(
    name: str, hard: str, scenes: Callable[[], Mapping[str, Scene]], may_stop: bool = False
) -> Callable[[Judge], Case]:
    """Makes the function below it, its judge, a case."""
    return lambda judge: Case(name, hard, scenes, judge, may_stop)


def runs(scene: str, of_run: Mapping[str, Sequence[str]], *common: str) -> Callable[[], dict[str, Scene]]:
    """Makes scenes from a packaged one: name -> overrides, in addition to those that all runs have in ``common``."""
    return lambda: {name: load_scene(scene, (*common, *overrides)) for name, overrides in of_run.items()}


def equal_curves(
    reference: str,
    measure: Callable[[Result, Result], float],
    tolerance: float,
    kind: Kind,
    meaning: str,
    name: str = "same-curve",
) -> Judge:
    """A judge that compares the curve of every run with that of the run named ``reference``."""

    def judge(trials: Trials) -> Iterator[Finding]:
        for other, trial in trials.items():
            if other != reference:
                yield Check(name, other, measure(trial.result, trials[reference].result), tolerance, kind, meaning)

    return judge


#: One arm, on a mesh that resolves the process zone of ``dcb-czm1`` with any basis; it costs no more than a coarse mesh
#: of both arms.
ONE_FINE_ARM = ("effects.symmetry=true", "discretization.dofs=6000")
