"""A reduction in words: the lines of its tables, for the terminal and for pages."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, isfinite, log10, nan

import numpy as np

from verify.reduction.equivalent_crack import LIKE_A_DCB
from verify.reduction.initiation import FIVE, NL, VIS
from verify.reduction.reduce import Reduced, Reduction, Value
from verify.studies.reduce.bias import Bias

#: Heads of the columns of `cells`.
HEADS = ("scheme", NL, FIVE, VIS, "propagation", "scatter", "rows", "G_II/G")


def lines(found: Reduction, known: Sequence[Bias]) -> list[str]:
    """The table on the terminal: a scheme a line, its values with the half widths of their intervals."""
    heads = (*HEADS, "against input") if known else HEADS
    table = [heads, *(cells(one, known) for one in found.schemes if not one.missing)]
    widths = [max(len(row[i]) for row in table) for i in range(len(heads))]
    shown = [
        "  ".join(cell.ljust(width) if i == 0 else cell.rjust(width) for i, (cell, width) in enumerate(pairs)).rstrip()
        for pairs in (tuple(zip(row, widths, strict=True)) for row in table)
    ]
    return [*shown, *(f"{one.name}: {one.missing}" for one in found.schemes if one.missing)]


def cells(one: Reduced, known: Sequence[Bias]) -> tuple[str, ...]:
    """A line of the table; with ``known`` toughness the deviation from it."""
    points = [with_interval(one.initiation[name]) if name in one.initiation else "-" for name in (NL, FIVE, VIS)]
    mixture = f"{one.mixture:.3f}" if isfinite(one.mixture) else "-"
    scatter = f"{one.scatter:.2g}" if isfinite(one.scatter) else "-"
    row = (one.name, *points, with_interval(one.propagation), scatter, str(one.count), mixture)
    if not known:
        return row
    off = next((bias.propagation for bias in known if bias.scheme is one), float("nan"))
    return *row, percent(off)


def with_interval(value: Value) -> str:
    """A text such as 0.2651 ± 0.0012, with digits down to the second one of the interval."""
    if not isfinite(value.value):
        return "-"
    if not isfinite(value.half) or value.half <= 5e-6 * abs(value.value):
        return f"{value.value:.5g}"
    size = floor(log10(abs(value.value))) if value.value else 0
    power = size if not -4 <= size < 6 else 0
    digits = min(12, max(0, 1 - floor(log10(value.half)) + power))
    text = " ± ".join(f"{one / 10.0**power:.{digits}f}" for one in (value.value, value.half))
    return f"({text})e{power}" if power else text


def facts(found: Reduction) -> list[tuple[str, str]]:
    """Results of the linear part, and the corrections made."""
    part, (low, high) = found.part, found.settings.window
    toe = f"{found.toe:.4g}, {'taken off' if found.settings.toe else 'left as it is'}"
    rows = [
        ("linear part", f"{part.rows.size} points, {100 * low:g} to {100 * high:g} % of the largest load"),
        ("compliance", f"{part.compliance:.5g}"),
        ("toe", toe),
    ]
    if found.settings.machine:
        rows.append(("machine compliance", f"{found.settings.machine:g}, taken off"))
    modulus = _modulus(found)
    if modulus is not None:
        rows.append(("flexural modulus E_f", with_interval(modulus)))
    rows.append(("modulus of the scene", f"{found.coupon.young:.5g}"))
    return [*rows, *(row for one in found.schemes if one.name != "CBBM" for row in _constants(one))]


def _constants(one: Reduced) -> list[tuple[str, str]]:
    return [(f"{key} of {one.name}", with_interval(value)) for key, value in one.constants.items() if key[0] != "E"]


def _modulus(found: Reduction) -> Value | None:
    return next((one.constants["E_f"] for one in found.schemes if "E_f" in one.constants), None)


@np.errstate(all="ignore")
def remarks(found: Reduction) -> list[str]:
    """Remarks on the reliability of the numbers."""
    said, modulus, young = [], _modulus(found), found.coupon.young
    if modulus is not None and abs(modulus.value / young - 1.0) > MODULI_DIFFER:
        said.append(
            f"the flexural modulus by the compliance is {percent(modulus.value / young - 1.0)} off that of the scene: "
            "a wrong modulus, precrack or machine compliance, or a bond that gives way early"
        )
    if found.settings.toe and found.toe < -NEGATIVE_TOE * found.rows.opening[np.argmax(found.rows.load)]:
        said.append(
            f"the linear part begins at a negative opening, {found.toe:.3g}, which is no slack: the bond gives way in "
            "it, or the opening was set to zero under load; --linear LOW,HIGH chooses lower loads, --no-toe leaves it"
        )
    J, other = (
        next((one.propagation.value for one in found.schemes if one.name == name), nan) for name in ("J", "CBBM")
    )
    if not 1.0 / FAR_APART < J / other < FAR_APART and isfinite(J / other):
        said.append(f"J is {J / other:.2g} of the toughness by the compliance: unit or signs of the rotations?")
    grown = found.rows.at(found.grown)
    spread = grown.opening / np.fmax(grown.crack, found.coupon.precrack)
    if found.coupon.kind in LIKE_A_DCB and not found.settings.large and spread.max(initial=0.0) > LARGE_OPENING:
        said.append(f"the opening is up to {spread.max():.2g} of the crack length: --large counts F and N in")
    if not found.grown.any():
        said.append("no row shows growth, so there is no propagation value")
    return said


def percent(part: float) -> str:
    return f"{100 * part:+.2f} %" if isfinite(part) else "-"


#: Relative difference from which the flexural modulus counts as different from that of the scene.
MODULI_DIFFER = 0.1
#: Negative toe, in parts of the opening at the largest load, from which it is more than noise.
NEGATIVE_TOE = 0.005
#: Factor between the toughness by J and by the compliance from which one of both is wrong.
FAR_APART = 3.0
#: Opening over crack length from which ASTM D5528 requires the factor F.
LARGE_OPENING = 0.4
