"""Numbers of checks by kind and state, and the state of a check in a table."""

from __future__ import annotations

from verify.pages.table import Cell, of_state
from verify.verdict import Check, Counts

#: Kind of a check -> the evidence behind it, in words.
EVIDENCE = {
    "exact": "An identity that any solution must meet. Nothing else is needed to judge it.",
    "analytical": "Against a closed form or the cohesive-beam solution, which rests on beam theory.",
    "certified": "Against values of two codes on three meshes each, with a stated uncertainty; kept, not run again.",
    "cross-code": "Against another code or a published value: two programs that share nothing but the problem.",
    "regression": "Against this code, earlier: says that nothing has changed, not that it is right.",
}


def mark(check: Check) -> Cell:
    """The state, and why it cannot be judged."""
    return of_state(check.state, check.unresolved)


def headline(counts: Counts, scenes: int) -> str:
    """The verdict in one line."""
    total = counts.total
    where = f"on {scenes} scene{'s' if scenes != 1 else ''}"
    if not total:
        return f"No check was made {where}"
    if counts.held < total:
        words = {"broken": counts.broken, "unresolved": counts.unresolved, "not covered": counts.not_covered}
        found = " and ".join(f"{number} {state}" for state, number in words.items() if number)
        return f"{found} of {total} checks {where}"
    return f"All {total} checks hold {where}" if total > 1 else f"The one check holds {where}"
