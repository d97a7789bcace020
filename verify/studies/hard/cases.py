"""All hard cases by name, in the order of the matrix: those that their modules define, one after the other."""

from __future__ import annotations

from collections.abc import Sequence

from verify.studies.hard import invariance, programmes, resolution, sliding
from verify.studies.hard.case import Case
from verify.studies.hard.combinations import COMBINATION_CASES
from verify.support.refusal import Refusal, suggestion

CASES: dict[str, Case] = {
    case.name: case
    for module in (resolution, programmes, sliding, invariance)
    for case in vars(module).values()
    if isinstance(case, Case)
} | {case.name: case for case in COMBINATION_CASES}


def chosen(names: Sequence[str]) -> tuple[Case, ...]:
    """The named cases; all of them where no name is given.

    Raises
    ------
    Refusal : a name is not that of a case
    """
    wrong = [name for name in names if name not in CASES]
    if wrong:
        hints = [suggestion(name, CASES) or f"the hard cases are {', '.join(CASES)}" for name in wrong]
        raise Refusal("\n".join(f"{name}: is no hard case; {hint}" for name, hint in zip(wrong, hints, strict=True)))
    return tuple(CASES[name] for name in dict.fromkeys(names)) if names else tuple(CASES.values())
