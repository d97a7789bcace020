"""Types of command-line options, each with its sentence for an invalid value."""

from __future__ import annotations

import argparse
import math
from pathlib import Path

#: Digits of an integer option.
LONGEST = 9


def positive(text: str) -> int:
    return _integer(text, 1)


def place(text: str) -> Path:
    """A file or folder; an empty name would be the working folder."""
    if not text.strip():
        raise argparse.ArgumentTypeError(f"must be the name of a file or folder, got {text!r}")
    return Path(text)


def count(text: str) -> int:
    return _integer(text, 0)


def seeds(text: str) -> tuple[int, int]:
    """First and last seed: N means 0 to N - 1, A-B means A to B."""
    first, dash, last = text.partition("-")
    try:
        ends = (count(first), count(last)) if dash else (0, positive(first) - 1)
    except argparse.ArgumentTypeError:
        ends = (1, 0)
    if ends[0] > ends[1]:
        raise argparse.ArgumentTypeError(f"must be a number >= 1, or two like 40-79, got {text!r}")
    return ends


def accuracy(text: str) -> float:
    share = text.removesuffix("%").strip()
    return fraction(share) / (100.0 if text.endswith("%") else 1.0)


def fraction(text: str) -> float:
    value = _float(text)
    if not value >= 0.0:
        raise argparse.ArgumentTypeError(f"must be a number >= 0, got {text!r}")
    return value


def column(text: str) -> str | int:
    return int(text) if _is_short_integer(text) else text


def columns(text: str) -> tuple[str | int, ...]:
    """Names or numbers of columns: ``3,4``."""
    found = tuple(column(part.strip()) for part in text.split(","))
    if "" in found:
        raise argparse.ArgumentTypeError(f"must be names or numbers of columns like 3,4, got {text!r}")
    return found


def scale(text: str) -> float:
    value = number(text)
    if value == 0.0:
        raise argparse.ArgumentTypeError(f"must be a finite number other than 0, got {text!r}")
    return value


def names_of(text: str) -> tuple[tuple[str, str], ...]:
    """Keys and names: ``p=S22,t=S12``."""
    pairs = tuple((key.strip(), name.strip()) for key, _, name in (one.partition("=") for one in text.split(",")))
    if not all(key and name for key, name in pairs):
        raise argparse.ArgumentTypeError(f"must be like p=S22,t=S12, got {text!r}")
    if len(dict(pairs)) < len(pairs):
        raise argparse.ArgumentTypeError(f"must name every key once, got {text!r}")
    return pairs


def scales_of(text: str) -> tuple[tuple[str, float], ...]:
    """Keys and factors: ``g=1e3,t=-1``."""
    return tuple((key, scale(value)) for key, value in names_of(text))


def numbers(text: str) -> list[float]:
    return [number(part) for part in text.split(",")]


def number(text: str) -> float:
    value = _float(text)
    if math.isnan(value):
        raise argparse.ArgumentTypeError(f"must be a finite number, got {text!r}")
    return value


def _integer(text: str, least: int) -> int:
    value = int(text) if _is_short_integer(text) else -1
    if value < least:
        most = f" and < {10**LONGEST}" if len(text) > LONGEST else ""
        raise argparse.ArgumentTypeError(f"must be an integer >= {least}{most}, got {text[:30]!r}")
    return value


def _is_short_integer(text: str) -> bool:
    return text.isascii() and text.isdigit() and len(text) <= LONGEST


def _float(text: str) -> float:
    """A finite number, or NaN for any other text."""
    try:
        value = float(text)
    except ValueError:
        return math.nan
    return value if math.isfinite(value) else math.nan
