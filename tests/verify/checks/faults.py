"""Runs with one thing wrong, and what their checks say."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from verify.checks.identities import run_checks
from verify.result import Result
from verify.scene.schema import Scene
from verify.verdict import Check

#: A fault is ten times the tolerance of its check.
SIZE = 10.0


def changed(
    result: Result, columns: str | Iterable[str], factor: object = 1.0, shift: object = 0.0, where: slice = slice(None)
) -> Result:
    """Columns times a factor with a shift, at some steps."""
    steps = {name: column.copy() for name, column in result.steps.items()}
    for name in [columns] if isinstance(columns, str) else columns:
        steps[name][where] = factor * steps[name][where] + shift
    return replace(result, steps=steps)


def having(result: Result, **columns: np.ndarray) -> Result:
    return replace(result, steps={**result.steps, **columns})


def judged(scene: Scene, result: Result) -> Mapping[str, Check]:
    return {check.name: check for check in run_checks(scene, result)}


def failed(scene: Scene, result: Result) -> set[str]:
    return {name for name, check in judged(scene, result).items() if not check.passed}


def first(found: Iterable[Check]) -> str:
    """The broken check that is furthest beyond its tolerance; empty where all hold."""
    broken = [check for check in found if check.state == "broken"]
    return max(broken, key=lambda check: abs(check.value) / check.tolerance).name if broken else ""


def of_that_size(found: Iterable[Check], name: str) -> bool:
    """Whether a fault is as large as it claims, for the check that finds it."""
    return any(0.5 <= abs(check.value) / (SIZE * check.tolerance) <= 2.0 for check in found if check.name == name)
