"""Types of command-line options, each with its sentence for an invalid value."""

from __future__ import annotations

import math
from argparse import ArgumentTypeError
from pathlib import Path

#: Digits of an integer option.
LONGEST = 9


def _wrong(rule: str, text: str) -> ArgumentTypeError:
    return ArgumentTypeError(f"must be {rule}, got {text[:60]!r}")


def place(text: str) -> Path:
    """A file or folder; an empty name would be the working folder."""
    if not text.strip():
        raise _wrong("the name of a file or folder", text)
    return Path(text)


def count(text: str, least: int = 0) -> int:
    if _is_short_integer(text) and int(text) >= least:
        return int(text)
    raise _wrong(f"an integer >= {least}" + f" and < {10**LONGEST}" * (len(text) > LONGEST), text)


def positive(text: str) -> int:
    return count(text, 1)


def positives(text: str) -> list[int]:
    return [positive(part) for part in text.split(",")]


def seeds(text: str) -> tuple[int, int]:
    """First and last seed: N means 0 to N - 1, A-B means A to B."""
    first, dash, last = text.partition("-")
    try:
        ends = (count(first), count(last)) if dash else (0, positive(first) - 1)
    except ArgumentTypeError:
        ends = (1, 0)
    if ends[0] > ends[1]:
        raise _wrong("a number >= 1, or two like 40-79", text)
    return ends


def number(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise _wrong("a finite number", text)
    return value


def numbers(text: str) -> list[float]:
    return [number(part) for part in text.split(",")]


def fraction(text: str) -> float:
    try:
        value = number(text)
    except ArgumentTypeError:
        value = -1.0
    if value < 0.0:
        raise _wrong("a number >= 0", text)
    return value


def accuracy(text: str) -> float:
    share = text.removesuffix("%")
    return fraction(share.strip()) / (100.0 if share != text else 1.0)


def scale(text: str) -> float:
    value = number(text)
    if value == 0.0:
        raise _wrong("a finite number other than 0", text)
    return value


def column(text: str) -> str | int:
    return int(text) if _is_short_integer(text) else text


def columns(text: str) -> tuple[str | int, ...]:
    """Names or numbers of columns: ``3,4``."""
    found = tuple(column(part.strip()) for part in text.split(","))
    if "" in found:
        raise _wrong("names or numbers of columns like 3,4", text)
    return found


def names_of(text: str) -> dict[str, str]:
    """Keys and names: ``p=S22,t=S12``."""
    pairs = [(key.strip(), name.strip()) for key, _, name in (one.partition("=") for one in text.split(","))]
    if not all(key and name for key, name in pairs):
        raise _wrong("like p=S22,t=S12", text)
    if len(dict(pairs)) < len(pairs):
        raise ArgumentTypeError(f"must name every key once, got {text!r}")
    return dict(pairs)


def scales_of(text: str) -> dict[str, float]:
    """Keys and factors: ``g=1e3,t=-1``."""
    return {key: scale(value) for key, value in names_of(text).items()}


def _is_short_integer(text: str) -> bool:
    return text.isascii() and text.isdigit() and len(text) <= LONGEST
