"""A reduction in words: the lines of its tables, for the terminal and for pages."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, isfinite, log10, nan

import numpy as np

from verify.reduction.initiation import FIVE, NL, VIS
from verify.reduction.reduce import Reduced, Reduction, Value
from verify.reduction.schemes import LIKE_A_DCB
from verify.studies.reduce.bias import Bias
from verify.support.say import aligned

#: Relative difference from which the flexural modulus counts as different from that of the scene.
MODULI_DIFFER = 0.1
#: Factor between both from which units are asked for, and how near, in decades, one of them must be: half the thickness
#: by which a modulus may be off as well, 1.3.
UNITS_FROM, SLIP_WITHIN = 1.9, 0.15
#: Units, halves and doubles -> what to do; by the flexural modulus over that of the scene, P a^3 / (delta b h^3).
UNIT_SLIPS = {
    1e-3: "loads in kN (--load-scale 1000) or openings in thousandths (--opening-scale 0.001)",
    1 / 4.4482: "loads in lbf (--load-scale 4.4482)",
    1 / 9.80665: "loads in kgf (--load-scale 9.80665)",
    1 / 8: "both arms for one (specimen.arm_thickness)",
    2.0: "half openings (--opening-scale 2)",
    8.0: "half an arm for one (specimen.arm_thickness)",
    10.0: "openings (--opening-scale 10) or the width in cm",
    25.4: "openings (--opening-scale 25.4) or the width in inches",
    1e3: "openings (--opening-scale 1000) or the width in m, or loads in thousandths (--load-scale 0.001)",
    0.5: "half loads (--load-scale 2)",
}
#: Negative toe, in parts of the opening at the largest load, from which it is more than noise.
NEGATIVE_TOE = 0.005
#: Factor between the toughness by J and by the compliance from which one of both is wrong.
FAR_FROM_COMPLIANCE = 3.0
#: Opening over crack length from which ASTM D5528 requires the factor F.
LARGE_OPENING = 0.4


def heads(known: Sequence[Bias]) -> tuple[str, ...]:
    """Heads of the columns of `cells`."""
    return ("scheme", NL, FIVE, VIS, "propagation", "scatter", "rows", "G_II/G", *["against input"] * bool(known))


def lines(found: Reduction, known: Sequence[Bias]) -> list[str]:
    """The table on the terminal: a scheme a line, its values with the half widths of their intervals."""
    table = aligned([heads(known), *(cells(one, known) for one in found.schemes if not one.missing)])
    return [*table, *(f"{one.name}: {one.missing}" for one in found.schemes if one.missing)]


def cells(one: Reduced, known: Sequence[Bias]) -> tuple[str, ...]:
    """A line of the table; with ``known`` toughness the deviation from it."""
    values = [with_interval(one.at(name)) for name in (NL, FIVE, VIS, "propagation")]
    mixture = f"{one.mixture:.3f}" if isfinite(one.mixture) else "-"
    scatter = f"{one.scatter:.2g}" if isfinite(one.scatter) else "-"
    off = [percent(next((bias.propagation for bias in known if bias.scheme is one), nan))] if known else []
    return (one.name, *values, scatter, str(one.count), mixture, *off)


def with_interval(found: Value) -> str:
    """A text such as 0.2651 ± 0.0012, with digits down to the second one of the interval."""
    value, half = found.value, found.half_width
    if not isfinite(value):
        return "-"
    if not isfinite(half) or half <= 5e-6 * abs(value):
        return f"{value:.5g}"
    size = floor(log10(abs(value))) if value else 0
    power = size if not -4 <= size < 6 else 0
    digits = min(12, max(0, 1 - floor(log10(half)) + power))
    text = " ± ".join(f"{one / 10.0**power:.{digits}f}" for one in (value, half))
    return f"({text})e{power}" if power else text


def facts(found: Reduction) -> list[tuple[str, str]]:
    """Results of the linear part, and the corrections made."""
    part, (low, high) = found.part, found.settings.window
    modulus, machine = _modulus(found), found.settings.machine
    linear = [
        ("linear part", f"{part.rows.size} points, {100 * low:g} to {100 * high:g} % of the largest load"),
        ("compliance", f"{part.compliance:.5g}"),
        ("toe", f"{found.toe:.4g}, {'taken off' if found.settings.toe else 'left as it is'}"),
    ]
    constants = [(one.name, *item) for one in found.schemes if one.name != "CBBM" for item in one.constants.items()]
    return [
        *(linear if part.rows.size else [("rows", f"{found.rows.load.size} of a growing crack, no linear part")]),
        *([("machine compliance", f"{machine:g}, taken off")] if machine else []),
        *([("flexural modulus E_f", with_interval(modulus))] if modulus is not None else []),
        ("modulus of the scene", f"{found.coupon.young:.5g}"),
        *((f"{key} of {name}", with_interval(value)) for name, key, value in constants if key[0] != "E"),
    ]


def _modulus(found: Reduction) -> Value | None:
    return next((one.constants["E_f"] for one in found.schemes if "E_f" in one.constants), None)


@np.errstate(all="ignore")
def remarks(found: Reduction) -> list[str]:
    """Remarks on the reliability of the numbers."""
    said, modulus, young = list[str](), _modulus(found), found.coupon.young
    curve, lead = found.r_curve, found.leading
    if curve is not None and lead is not None:
        start = lead.at(FIVE).value
        length = f"after {curve.length:.3g} of growth" if curve.reached else "at the end, where it has no plateau yet"
        said.append(
            f"G rises along the crack, and one mean is not the answer: by {lead.name} from "
            f"{start if isfinite(start) else curve.initiation:.3g} at initiation to {curve.plateau:.3g} {length}; the "
            f"noise is {curve.noise:.1g}"
        )
    if (mu := found.coupon.friction) and found.coupon.kind == "enf":
        part = 4.0 / 3.0 * mu * found.coupon.h / found.coupon.precrack
        said.append(
            f"friction of the faces, {mu:g}, keeps (4/3) mu h / a = {percent(part)} of G from the crack (Carlsson, "
            "Gillespie, Pipes 1986): every scheme counts it as toughness"
        )
    if found.coupon.kind == "peel" and not found.rows.virtual:
        line = (
            "" if found.rows.J is not None else "; the arm is taken to be in line with the load, as no rotation is read"
        )
        said.append(f"what plastic bending dissipates is left out, and counts as toughness{line}")
    if modulus is not None and abs(modulus.value / young - 1.0) > MODULI_DIFFER:
        said.append(
            f"the flexural modulus by the compliance is {percent(modulus.value / young - 1.0)} off that of the scene: "
            + _why_modulus(modulus.value / young, found.coupon.width)
        )
    if found.settings.toe and found.toe < -NEGATIVE_TOE * found.rows.opening[np.argmax(found.rows.load)]:
        said.append(
            f"the linear part begins at a negative opening, {found.toe:.3g}, which is no slack: the bond gives way in "
            "it, or the opening was set to zero under load; --linear LOW,HIGH chooses lower loads, --no-toe leaves it"
        )
    toughness = {one.name: one.propagation.value for one in found.schemes}
    over = toughness.get("J", nan) / toughness.get("CBBM", nan)
    if isfinite(over) and not 1.0 / FAR_FROM_COMPLIANCE < over < FAR_FROM_COMPLIANCE:
        said.append(f"J is {over:.2g} of the toughness by the compliance: unit or signs of the rotations?")
    grown = found.rows.at(found.grown)
    spread = grown.opening / np.where(np.isfinite(grown.crack), grown.crack, found.equivalent[found.grown])
    if found.coupon.kind in LIKE_A_DCB and not found.settings.large and np.nanmax(spread, initial=0.0) > LARGE_OPENING:
        said.append(f"the opening is up to {np.nanmax(spread):.2g} of the crack length: --large counts F and N in")
    if not found.grown.any():
        said.append("no row shows growth, so there is no propagation value")
    return said


def _why_modulus(ratio: float, width: float) -> str:
    """What makes a flexural modulus ``ratio`` times that of the scene: from a factor of 2 on the nearest slip."""
    if 1.0 / UNITS_FROM < ratio < UNITS_FROM:
        return "a wrong modulus, precrack or machine compliance, or a bond that gives way early"
    slips = {**UNIT_SLIPS, 1.0 / width: f"loads over the width (--load-scale {width:g})"}
    near = sorted(slips, key=lambda one: abs(log10(one / ratio)))[:2]
    near = [one for one in near if abs(log10(one / ratio)) < SLIP_WITHIN]
    return f"{' or '.join(slips[one] for one in near) or 'units of loads, openings or moduli'}? A wrong specimen?"


def percent(part: float) -> str:
    return f"{100 * part:+.2f} %" if isfinite(part) else "-"
