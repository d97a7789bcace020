"""Plan of the study: the scene with every combination of the values that ``--set KEY=a,b,c`` gives to its keys."""

from __future__ import annotations

import re
import shutil
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

from verify.runs.fingerprint import digest
from verify.runs.jobs import Job, left_out
from verify.runs.sweep import Task
from verify.scene.load import load_scene
from verify.studies.pairs import Pair
from verify.studies.vary.ranks import MPIRUN_MISSING
from verify.support.refusal import Refusal

#: The values of a key: lists, strings, or what is between commas.
VALUES = re.compile(r"""\[\[.*?\]\]|\[.*?\]|"[^"]*"|[^,]+""")


@dataclass(frozen=True)
class Run(Job):
    """A run on a number of MPI ranks."""

    ranks: int = 1

    def task(self) -> Task:
        """The run as a task of a sweep, under mpirun for more than one rank."""
        alone = super().task()
        if self.ranks == 1:
            return alone
        program = ("verify.studies.vary.ranks", str(self.ranks), *alone.program[1:])
        return replace(alone, key=digest(alone.key, program), program=program)


@dataclass(frozen=True)
class Plan:
    """Pairs of every variant with the first one, which is paired with itself; a sentence for what cannot be run."""

    pairs: tuple[Pair, ...]
    left_out: tuple[str, ...]


def planned(source: str, overrides: Sequence[str], method: str, ranks: Sequence[int] = (1,)) -> Plan:
    """The runs of a scene with one method.

    Raises
    ------
    Refusal : no key has several values, a value is not allowed, or the method cannot solve the first variant.
    """
    if any(n > 1 for n in ranks) and (why := _without_ranks(method)):
        raise Refusal(f"--ranks: {why}")
    given = {key.strip(): VALUES.findall(text) or [""] for key, _, text in (one.partition("=") for one in overrides)}
    varied = {key: values for key, values in given.items() if len(values) > 1}
    if not varied and len(ranks) < 2:
        raise Refusal("--set: must give a key several values, as in --set discretization.dofs=2000,1000,500")
    scene = load_scene(source)
    own = load_scene(source, [f"{key}={values[0]}" for key, values in given.items() if key not in varied])
    runs: dict[str, Run] = {}
    reasons = []
    for values in product(*given.values()):
        for n in ranks:
            chosen = dict(zip(given, values, strict=True))
            name = ", ".join([f"{key} {chosen[key]}" for key in varied] + [f"{n} ranks"] * (len(ranks) > 1))
            words = tuple(f"{key}={value}" for key, value in chosen.items())
            load_scene(source, words)
            variant = "-".join(["vary/" + method, *re.findall(r"[\w.+]+", name)])
            run = Run(source, scene, method, variant, words, fields=False, ranks=n)
            if not (why := left_out(run)):
                runs[name] = run
            elif runs:
                reasons.append(f"{name}: left out: {why}")
            else:
                raise Refusal(f"{name}: {why}")
    (title, first), key = next(iter(runs.items())), ", ".join([*varied, *["ranks"] * (len(ranks) > 1)])
    one = len(varied) + (len(ranks) > 1) == 1  # then a value without its key, which may be a number
    value = {name: name.removeprefix(f"{key} ").removesuffix(" ranks") if one else name for name in runs}
    pairs = (
        Pair(name, key, value[name], value[title], run, first, run.ranks == 1 and run.solved == own)
        for name, run in runs.items()
    )
    return Plan(tuple(pairs), tuple(reasons))


def _without_ranks(method: str) -> str:
    """Why a method cannot run on several ranks here; empty where it can."""
    if method != "dolfinx":
        return f"is only for --method dolfinx, got {method}"
    return "" if shutil.which("mpirun") else MPIRUN_MISSING
