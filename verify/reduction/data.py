"""What a test measured: opening, load, and where there are any crack lengths and rotations of the arms."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from verify.curves.read import Column, CurveError, NoSuchColumn, Reading, read_with_more, usable_scales
from verify.reduction.coupon import Coupon
from verify.support.refusal import Refusal

#: Columns of a run, beside opening and load.
CRACK_COLUMN = "crack_length"
_ROTATIONS = "face_slope_bottom", "face_slope_top"
#: Kind -> most columns of rotations.
ROTATIONS = {"dcb": 2, "adcb": 2, "peel": 1}
#: Difference of two rotations, in parts of the sum of both, below which both ends turn in one sense.
ONE_SENSE = 0.1
#: Scales that turn one unit of length into another: mm, cm, m, inches and thousandths of a mm.
UNIT_SCALES = (1000.0, 25.4, 10.0, 0.1, 1.0 / 25.4, 0.001)
#: How far readings of a crack length may go back, or fall short of the precrack, in parts of it.
SLACK = 0.05


@dataclass(frozen=True)
class Measured:
    """Rows of a test, in the order in which they were taken.

    Parameters
    ----------
    opening, load : (n,) both above 0 on loading
    crack : (n,) length from the load line, or the left support; NaN where none was read
    J : (n,) J-integral from rotations or of a run, None without
    front : (n,) where damage begins, of a run; None of a test
    end : (n,) opening at the end of the precrack, None where it was not measured
    virtual : whether it is a run of this project
    """

    source: str
    opening: np.ndarray
    load: np.ndarray
    crack: np.ndarray
    J: np.ndarray | None = None
    front: np.ndarray | None = None
    virtual: bool = False
    end: np.ndarray | None = None

    @property
    def has_cracks(self) -> bool:
        return bool(np.isfinite(self.crack).any())

    @property
    def compliance(self) -> np.ndarray:
        """Opening over load (n,), NaN without load."""
        return self.opening / np.where(self.load > 0.0, self.load, np.nan)

    def at(self, rows: np.ndarray) -> Measured:
        """Some of the rows, by index or mask."""
        names = ("opening", "load", "crack", "J", "front", "end")
        return replace(self, **{name: one[rows] for name in names if (one := getattr(self, name)) is not None})


@dataclass(frozen=True)
class Columns:
    """Where a table has what: opening and load as `Reading` says, and the columns that only a reduction reads.

    ``crack_offset`` is added to the crack lengths, the precrack where their column holds the growth. ``rotations`` are
    those of both loaded ends, or of one for both, anticlockwise or both in the other sense; of a peel test that of the
    pulled end. ``end`` is the opening at the end of the precrack, with the scale of the opening.

    Raises
    ------
    CurveError : a scale that is 0 or not finite.
    """

    reading: Reading = Reading()
    crack: Column | None = None
    crack_scale: float = 1.0
    crack_offset: float = 0.0
    rotations: tuple[Column, ...] = ()
    rotation_scale: float = 1.0
    end: Column | None = None

    def __post_init__(self) -> None:
        usable_scales(crack_scale=self.crack_scale, rotation_scale=self.rotation_scale)


def read_measured(path: Path, columns: Columns, coupon: Coupon) -> Measured:
    """Rows of a text file, or of the curve.csv in a folder.

    A column named crack_length counts without being asked for.

    Raises
    ------
    CurveError, Refusal : no curve, no such column, rotations of a kind that has no use for them, or crack lengths that
        cannot be: not above 0, shorter than the precrack, beyond the specimen, or decreasing.
    """
    turns, ends = columns.rotations, () if columns.end is None else (columns.end,)
    if len(turns) > ROTATIONS.get(coupon.kind, 0):
        raise Refusal(
            f"rotations: must be up to two of a dcb or adcb, or one of a peel, got {len(turns)} of {coupon.kind}"
        )
    if ends and coupon.kind != "dcb":
        raise Refusal(f"end opening: must be of a dcb, got the kind {coupon.kind!r}")
    others = (*turns, *ends)
    scales = (columns.rotation_scale,) * len(turns) + (columns.reading.opening_scale,) * len(ends)
    wanted = replace(
        columns.reading, more=(columns.crack or CRACK_COLUMN, *others), more_scales=(columns.crack_scale, *scales)
    )
    try:
        d, P, more = read_with_more(path, wanted)
    except NoSuchColumn:
        if columns.crack is not None:
            raise
        d, P, more = read_with_more(path, replace(wanted, more=others, more_scales=scales))
    crack = more[0] if len(more) > len(others) else np.full(d.size, np.nan)
    crack = np.where((crack == 0.0) & (d == 0.0), np.nan, crack)  # the first row of a curve.csv is all zeros
    crack = crack + columns.crack_offset
    rotations = more[len(more) - len(others) :][: len(turns)]
    if turns and coupon.kind == "peel":
        turn = np.cos(coupon.angle - np.abs(rotations[0])) - np.cos(coupon.angle)
    else:
        turn = _turn(path, rotations) if turns else np.nan
    J = P * turn / coupon.width if turns else None
    if not P.max() > 0.0:
        way = "; a load scale of -1 turns signs" if P.min() < 0.0 else ""
        raise CurveError(f"{path}: the loads must go above 0, got at most {P.max() + 0.0:g}{way}")
    end = more[-1] if ends else None
    return _sound_cracks(Measured(str(path), d, P, crack, J, end=end), coupon, columns.crack_scale)


def _turn(path: Path, rotations: np.ndarray) -> np.ndarray:
    """sin(theta_2) - sin(theta_1) (n,) of anticlockwise rotations, above 0 where the arms open.

    J = P (sin theta_2 - sin theta_1) / w: Paris and Paris (1988), Int. J. Fract. 38, R19-R21, for small rotations; with
    sines exact for large ones (Nilsson 2006, Eng. Fract. Mech. 73, 2101-2112). Both signs turn with the side that is
    looked at, so the sign is the one that makes J grow.

    Raises
    ------
    CurveError : rotations of a right angle or more, or both in one sense.
    """
    largest = float(np.nanmax(np.abs(rotations), initial=0.0))
    if largest >= 0.5 * np.pi:
        scale = "--rotation-scale 0.017453 reads degrees, 0.001 thousandths"
        raise CurveError(f"{path}: the rotations must be less than a right angle, pi/2, got {largest:g}; {scale}")
    sines = np.sin(rotations)
    turn = 2.0 * sines[0] if len(sines) == 1 else sines[1] - sines[0]
    if len(sines) == 2 and np.nansum(np.abs(turn)) < ONE_SENSE * np.nansum(np.abs(sines)):
        raise CurveError(
            f"{path}: the rotations must have different signs where the arms open, as both count anticlockwise, got "
            "two of one sign; turn the sign of one column"
        )
    return turn * np.sign(np.nansum(turn) or 1.0)


def of_steps(source: str, steps: Mapping[str, np.ndarray], coupon: Coupon) -> Measured:
    """A run of this project: all its rows, its crack length, and its J where it has one.

    J of end faces is P (s_2 - s_1) / w without their own strain energy, as rotations in a laboratory give it.
    """
    d, P = steps["opening"], steps["load"]
    J = steps.get("J_loads")
    if J is None and set(_ROTATIONS) <= set(steps):
        bottom, top = (steps[name] for name in _ROTATIONS)
        # the slope of a strip that is stretched is more than the sine of its rotation
        turn = top / (1.0 + P * top / coupon.stretching) if coupon.kind == "peel" else bottom - top
        J = P * turn / coupon.width
    crack = steps.get(CRACK_COLUMN, np.full(d.size, np.nan))
    return Measured(source, d, P, crack, J, steps.get("damage_front"), virtual=True)


def _sound_cracks(measured: Measured, coupon: Coupon, scale: float) -> Measured:
    """The rows, if crack lengths can be what they are called."""
    at = np.flatnonzero(np.isfinite(measured.crack))
    crack = measured.crack[at]
    if not at.size:
        return measured
    shortest, longest, back = float(crack.min()), float(crack.max()), np.maximum.accumulate(crack) - crack
    i, j = int(np.argmax(back)), int(np.argmin(crack))
    why = _why_off(coupon, shortest, longest, scale)
    turn = f"--crack-scale {-scale:g} --crack-offset {coupon.length:g}"
    left = f"; what is left of the specimen ({turn})?" if np.all(np.diff(crack) <= SLACK * longest) else ""
    rules = {
        f"be above 0, got {shortest:g} in point {at[j] + 1}": shortest >= 0.0,
        f"be >= specimen.precrack = {coupon.precrack:g}, got {shortest:g} in point {at[j] + 1}; {why}": shortest
        >= coupon.precrack * (1.0 - SLACK),
        f"be <= specimen.length = {coupon.length:g}, got {longest:g}; {why}": longest <= coupon.length,
        f"not decrease, got {crack[i]:g} in point {at[i] + 1} after {crack[: i + 1].max():g}{left}": back[i]
        <= SLACK * longest,
    }
    broken = next((rule for rule, holds in rules.items() if not holds), "")
    if broken:
        raise CurveError(f"{measured.source}: the crack length must {broken}")
    return measured


def _why_off(coupon: Coupon, shortest: float, longest: float, scale: float) -> str:
    """What crack lengths out of range may be: in another unit, growth, or told from another place."""
    least = coupon.precrack * (1.0 - SLACK)
    scales = [one for one in UNIT_SCALES if least <= one * shortest and one * longest <= coupon.length]
    ways = [f"in another unit (--crack-scale {one * scale:g})" for one in scales]
    elsewhere = "told from another place than the load (--crack-offset), or of another specimen"
    if longest <= coupon.length - coupon.precrack and shortest < 0.5 * coupon.precrack:
        ways.append(f"its growth (--crack-offset {coupon.precrack:g})")
    return f"{' or '.join(ways or [elsewhere])}?"
