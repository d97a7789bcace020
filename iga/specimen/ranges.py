"""Ranges of the fields of a record: a value out of its range is refused with its key and the rule."""

from __future__ import annotations

from dataclasses import fields
from math import inf
from typing import Any

import numpy as np


def require(record: object, key: str, holds: bool, rule: str) -> None:
    """Raise ValueError with key, rule and value where a field of a record breaks a rule."""
    if not holds:
        raise ValueError(f"{key}: must be {rule}, got {getattr(record, key)!r}")


def require_numbers(record: Any) -> None:
    """Raise ValueError where a field of a dataclass that is annotated as a number holds something else."""
    for field in fields(record):
        kind, _, none = str(field.type).partition(" | ")
        value = getattr(record, field.name)
        if kind in ("int", "float") and not (none and value is None):
            scalar = np.ndim(value) == 0 and np.asarray(value).dtype.kind in "iuf"
            require(record, field.name, scalar, "a number")


def require_positive(record: object, *keys: str) -> None:
    """Raise ValueError where one of these fields is given and is not positive and finite."""
    for key in keys:
        value = getattr(record, key)
        require(record, key, value is None or 0.0 < value < inf, "> 0 and finite")
