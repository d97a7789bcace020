"""A diagnosis as a sentence."""

from __future__ import annotations

from collections.abc import Sequence

from verify.diagnosis.causes import Number
from verify.verdict import Diagnosis, Explanation

#: Factor of a number from which on it is not said in percent.
BEYOND_PERCENT = 3.0


def of_number(number: Number, part: float) -> str:
    """The modulus is 4.1 % lower."""
    comparative = number.more if part > 0 else number.less
    if not 1.0 / BEYOND_PERCENT < 1.0 + part < BEYOND_PERCENT:
        return f"{number.name} {comparative} by a factor of {max(1.0 + part, 1.0 / (1.0 + part)):.3g}"
    return f"{number.name} {percent(abs(part))} {comparative}"


def sentence(found: Diagnosis) -> str:
    """What explains the deviation best, by how much, and what is left."""
    if not found.causes:
        return f"{found.curve}: no cause was found"
    first = found.causes[0]
    if not found.explained:
        nearest = f"{first.words}, which leaves {_of_reference(first.error_with)}"
        deviation = _of_reference(first.error_without)
        return f"{found.curve}: no single cause explains the deviation of {deviation}; the nearest is {nearest}"
    same = [one.words for one in found.causes if one.name in found.alike]
    text = f"{found.curve}: best explained by {' or '.join([first.words, *same])}: {_left(first)}"
    return text + ("; this curve cannot tell them apart" if same else "")


def _left(one: Explanation) -> str:
    return f"the curve error is {_of_reference(one.error_without)}, and {_of_reference(one.error_with)} without it"


def unseen(curve: str, words: Sequence[str], tolerance: float) -> str:
    """What a pass does not show."""
    listed = "; ".join(words)
    least = f"move the curve by less than {_of_reference(tolerance)}"
    return f"{curve}: passes, and would pass with any of these, which {least}: {listed}"


def percent(part: float) -> str:
    """A part in percent: two digits, and whole ones from 100 % on."""
    return f"{100 * part:.0f} %" if abs(part) >= 0.995 else f"{100 * part:.2g} %"


def _of_reference(part: float) -> str:
    """A deviation of the loads, as a part of the reference."""
    if part < 5e-5:
        return "less than 0.01 %"
    if part < 10.0:
        return percent(part)
    return f"{part:.0f} times the reference" if part < 1e5 else f"{part:.0e} times the reference"
