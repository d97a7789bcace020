"""A hard case, its runs, and what its criteria find."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from iga.bases.names import BASES
from verify.result import Result
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.verdict import Check


@dataclass(frozen=True)
class Variant:
    """One run of a case: the name of its folder, and its scene."""

    name: str
    scene: Scene


@dataclass(frozen=True)
class Trial:
    """A variant with its result."""

    variant: Variant
    result: Result

    @property
    def name(self) -> str:
        return self.variant.name

    @property
    def scene(self) -> Scene:
        return self.variant.scene


@dataclass(frozen=True)
class Number:
    """A number that is reported without a tolerance."""

    name: str
    subject: str
    value: float
    meaning: str


Finding = Check | Number
Trials = Mapping[str, Trial]


def no_judge(trials: Trials) -> Iterator[Finding]:
    """The judge of a case that has only the criteria of every case."""
    yield from ()


@dataclass(frozen=True)
class Case:
    """A hard case.

    Parameters
    ----------
    hard : the difficulty, in one sentence
    variants : makes the runs
    judge : criteria of all runs together, in addition to those that every run has to meet (``criteria.common``)
    may_stop : runs may end before their programme does; ``judge`` decides about their end
    bases : bases for which the case is defined
    """

    name: str
    hard: str
    variants: Callable[[], Sequence[Variant]]
    judge: Callable[[Trials], Iterator[Finding]] = no_judge
    may_stop: bool = False
    bases: tuple[str, ...] = tuple(BASES)


#: One arm, on a mesh that resolves the process zone of ``dcb-czm1`` with any basis; it costs no more than a coarse mesh
#: of both arms.
ONE_FINE_ARM = ("effects.symmetry=true", "discretization.dofs=6000")


def variant(name: str, scene: str, *overrides: str) -> Variant:
    """A run of a packaged scene with overrides."""
    return Variant(name, load_scene(scene, overrides))


def variants(scene: str, runs: Mapping[str, Sequence[str]], *common: str) -> Callable[[], list[Variant]]:
    """Makes runs of a packaged scene: name -> overrides, in addition to those that all runs have in ``common``."""
    return lambda: [variant(name, scene, *common, *overrides) for name, overrides in runs.items()]
