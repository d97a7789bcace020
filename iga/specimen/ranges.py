"""Ranges of the fields of a record: a value out of its range is refused with its key and the rule."""

from __future__ import annotations

from math import inf


def require(record: object, key: str, holds: bool, rule: str) -> None:
    """Raise ValueError with key, rule and value where a field of a record breaks a rule."""
    if not holds:
        raise ValueError(f"{key}: must be {rule}, got {getattr(record, key)!r}")


def require_positive(record: object, *keys: str) -> None:
    """Raise ValueError where one of these fields is given and is not positive and finite."""
    for key in keys:
        value = getattr(record, key)
        require(record, key, value is None or 0.0 < value < inf, "> 0 and finite")
