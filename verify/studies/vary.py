"""What any key changes and costs: the scene with every combination of the values that ``--set KEY=a,b,c`` gives.

Each is held against the first; where the meshes differ enough, it is said how time and memory grow with the unknowns.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from itertools import product
from typing import ClassVar

from verify.methods.solve import prepare
from verify.runs.fingerprint import digest
from verify.runs.jobs import Job, left_out
from verify.runs.sweep import Task
from verify.scene.load import load_scene
from verify.studies import pairs
from verify.studies.frame import power
from verify.studies.pairs import Pair, Plan, Row
from verify.support.refusal import Refusal

#: The values of a key: lists, strings, or what is between commas.
VALUES = re.compile(r"""\[\[.*?\]\]|\[.*?\]|"[^"]*"|[^,]+""")

#: The largest over the least number of unknowns from which on their growth is stated.
GROWN = 4.0

MPIRUN_MISSING = "mpirun is not installed"


@dataclass(frozen=True)
class Run(Job):
    """A run on a number of MPI ranks."""

    ranks: int = 1

    def task(self) -> Task:
        """The run as a task of a sweep, under mpirun for more than one rank."""
        alone = super().task()
        if self.ranks == 1:
            return alone
        program = ("verify.studies.vary", str(self.ranks), *alone.program[1:])
        return replace(alone, key=digest(alone.key, program), program=program)


@dataclass(frozen=True)
class Study(pairs.Study):
    """Results; the first row is that of the variant which the others are held against."""

    NAME: ClassVar[str] = "vary"

    @property
    def title(self) -> str:
        return f"What {self.rows[0].key} changes"

    @property
    def sentences(self) -> list[str]:
        first, *others = self.rows
        head = f"{first.name}: {first.steps} steps, {first.seconds:.2g} s" if first.complete else first.sentence
        return [head, *(one.sentence for one in others), *growth(self.rows)]

    def about(self) -> dict[str, object]:
        return {"method": self.method, "sentences": self.sentences, "rows": [asdict(one) for one in self.rows]}


def growth(rows: Sequence[Row]) -> list[str]:
    """Power law of the time of an iteration, and memory for each thousand unknowns, where meshes differ enough."""
    rows = sorted((one for one in rows if one.complete and one.dofs), key=lambda one: one.dofs)
    if len(rows) < 3 or rows[-1].dofs < GROWN * rows[0].dofs:
        return []
    exponent, error = power([one.dofs for one in rows], [one.iteration for one in rows])
    first, last = rows[0], rows[-1]
    memory = (last.peak_memory_mb - first.peak_memory_mb) / (last.dofs - first.dofs)
    time = f"an iteration takes N^{exponent:.2f} +- {error:.2f}, {last.iteration:.2g} s at the end"
    return [f"{first.dofs} to {last.dofs} unknowns: {time}; memory grows by {1000 * memory:.2g} MB for every thousand"]


def planned(source: str, overrides: Sequence[str], method: str, ranks: Sequence[int] = (1,)) -> Plan:
    """The runs of a scene with one method.

    Raises
    ------
    Refusal : no key has several values, a value is not allowed, or the method cannot solve the first variant.
    """
    if any(n > 1 for n in ranks):
        if method != "dolfinx":
            raise Refusal(f"--ranks: is only for --method dolfinx, got {method}")
        if not shutil.which("mpirun"):
            raise Refusal(f"--ranks: {MPIRUN_MISSING}")
    given = {key.strip(): VALUES.findall(text) or [""] for key, _, text in (one.partition("=") for one in overrides)}
    factors = {**given, "ranks": [*map(str, ranks)]}
    varied = [key for key, values in factors.items() if len(values) > 1]
    if not varied:
        raise Refusal("--set: must give a key several values, as in --set discretization.dofs=2000,1000,500")
    scene = load_scene(source)
    own = load_scene(source, [f"{key}={values[0]}" for key, values in given.items() if key not in varied])
    runs: dict[str, Run] = {}
    reasons = []
    for values in product(*factors.values()):
        chosen = dict(zip(factors, values, strict=True))
        name = ", ".join(f"{key} {chosen[key]}" for key in varied)
        n, words = int(chosen.pop("ranks")), tuple(f"{key}={value}" for key, value in chosen.items())
        load_scene(source, words)
        variant = "-".join(["vary/" + method, *re.findall(r"[\w.+]+", name)])
        run = Run(source, scene, method, variant, words, fields=False, ranks=n)
        if not (why := left_out(run)):
            runs[name] = run
        elif runs:
            reasons.append(f"{name}: left out: {why}")
        else:
            raise Refusal(f"{name}: {why}")
    (title, first), key = next(iter(runs.items())), ", ".join(varied)
    value = {name: name.removeprefix(f"{key} ") for name in runs}  # of one key alone, which may be a number
    found = tuple(
        Pair(name, key, value[name], value[title], run, first, run.ranks == 1 and run.solved == own)
        for name, run in runs.items()
    )
    return Plan(first, found, (*reasons, *chosen_otherwise(found)))


def chosen_otherwise(found: Sequence[Pair]) -> list[str]:
    """A sentence for each variant for which "auto" chooses other effects than for the first one, and keys do not."""
    first, *others = ((pair.name, prepare(pair.one.solved, pair.one.method)) for pair in found)
    return [
        f"{name}: effects.{one.key} is {one.value} by itself, and {before} for {first[0]}"
        for name, prepared in others
        for one in prepared.decisions
        if one.value != (before := first[1].effects.get(one.key))
    ]


def under_mpirun(ranks: str, words: Sequence[str]) -> list[str]:
    """The program and its arguments: ``debond WORD ...`` on so many ranks."""
    return ["mpirun", "-n", ranks, sys.executable, "-P", "-m", "verify", *words]


if __name__ == "__main__":  # replaced by mpirun, so that the end of this process is that of all ranks
    sys.stdout.flush()
    os.execvp("mpirun", under_mpirun(sys.argv[1], sys.argv[2:]))
