"""A diagnosis as a sentence."""

from __future__ import annotations

from collections.abc import Sequence

from verify.diagnosis.causes import Number
from verify.verdict import Diagnosis, Explanation


def of_number(number: Number, part: float) -> str:
    """The modulus is 4.1 % lower."""
    return f"{number.name} {100 * abs(part):.2g} % {number.more if part > 0 else number.less}"


def sentence(found: Diagnosis) -> str:
    """What explains the deviation best, by how much, and what is left."""
    if not found.causes:
        return f"{found.curve}: no cause was found"
    first = found.causes[0]
    if not found.explained:
        return (
            f"{found.curve}: no single cause explains the deviation of {_percent(first.error_without)}; the nearest is "
            f"{first.words}, which leaves {_percent(first.error_with)}"
        )
    same = [one.words for one in found.causes if one.name in found.alike]
    text = f"{found.curve}: best explained by {' or '.join([first.words, *same])}: {_left(first)}"
    return text + ("; this curve cannot tell them apart" if same else "")


def _left(one: Explanation) -> str:
    return f"the curve error is {_percent(one.error_without)}, and {_percent(one.error_with)} without it"


def unseen(curve: str, words: Sequence[str], tolerance: float) -> str:
    """What a pass does not show."""
    listed = "; ".join(words)
    least = f"move the curve by less than {_percent(tolerance)}"
    return f"{curve}: passes, and would pass with any of these, which {least}: {listed}"


def _percent(part: float) -> str:
    return f"{100 * part:.2g} %" if part < 10 else f"{part:.2g} times the reference"
