"""What a hard case is made of."""

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
    """One run of a case; the name is that of its folder."""

    name: str
    scene: Scene


@dataclass(frozen=True)
class Trial:
    """A variant with what came of it."""

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
    """Something worth reporting that no tolerance stands behind."""

    name: str
    subject: str
    value: float
    meaning: str


Finding = Check | Number
Trials = Mapping[str, Trial]


def nothing(trials: Trials) -> Iterator[Finding]:
    """A case that has to show no more than what every case must."""
    yield from ()


@dataclass(frozen=True)
class Case:
    """A hard case.

    Parameters
    ----------
    hard : one sentence, what is hard
    variants : makes the runs
    judge : findings about all runs together, beyond what every run must show (``criteria.common``)
    may_stop : runs may end before the programme does, as ``judge`` allows
    bases : those that can have what the case asks for
    """

    name: str
    hard: str
    variants: Callable[[], Sequence[Variant]]
    judge: Callable[[Trials], Iterator[Finding]] = nothing
    may_stop: bool = False
    bases: tuple[str, ...] = tuple(BASES)


#: One arm on a mesh that resolves the process zone of ``dcb-czm1`` with any basis, at the price of a coarse one.
FINE = ("effects.symmetry=true", "discretization.dofs=6000")


def variant(name: str, scene: str, *overrides: str) -> Variant:
    """A packaged scene with some of its keys replaced, named after what it shows."""
    return Variant(name, load_scene(scene, overrides))
