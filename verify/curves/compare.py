"""Comparison of two load-opening curves, of any code."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verify.curves.curve import PROPAGATION, curve_error, envelope, from_origin, load_at, oscillation, peak, samples
from verify.curves.leg_checks import OF_A_POINT, LegDifference, farthest, leg_checks, leg_differences
from verify.curves.legs import SAME_TURN, TURN_TOLERANCE, Path, path, programme_of
from verify.curves.read import CurveError
from verify.support.programme import turns
from verify.verdict import Check

#: Points on the propagation branch below which a wave cannot be distinguished from the sampling.
POINTS_OF_A_WAVE = 10

#: Part of the tolerance of the curve by which its end and its turns may miss those of B, of the largest opening.
OF_AN_END = 0.2

Points = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Part:
    """The compared part of a curve."""

    opening: np.ndarray  # (n,) path from the first arrival at the beginning to that at the end
    load: np.ndarray  # (n,)
    first: float  # opening at which the given curve begins and ends
    last: float
    peak_opening: float  # of the envelope
    peak_load: float
    work: float  # integral of load over opening along the path, by the trapezoidal rule


@dataclass(frozen=True)
class Comparison:
    """A against B over the openings (begin, end].

    ``curve_error``, ``peak_difference``, ``peak_shift`` and ``energy_difference`` are relative to B. Oscillation is of
    the whole branch behind the peak, NaN where it is undefined.
    """

    a: Part
    b: Part
    asked_end: float  # the opening up to which B was to be compared
    end: float  # as far as A reaches
    curve_error: float
    oscillation_rms: float
    excess_variation: float
    opening_n: np.ndarray  # (SAMPLES,) and the loads of both envelopes there
    load_a_n: np.ndarray
    load_b_n: np.ndarray
    names: tuple[str, str] = ("A", "B")
    begin: float = 0.0
    paths: tuple[Path, Path] = (Path((), 0.0), Path((), 0.0))  # along the programme

    @property
    def legs(self) -> tuple[LegDifference, ...]:
        """Every leg of a programme that turns; no leg where the opening only grows."""
        return leg_differences(*self.paths) if len(self.paths[1].legs) > 1 else ()

    @property
    def reaches(self) -> bool:
        return self.missing <= SAME_TURN

    @property
    def missing(self) -> float:
        """Share of the openings asked for that A does not reach."""
        return max(0.0, 1.0 - self.a.last / self.asked_end)

    @property
    def peak_difference(self) -> float:
        return self.a.peak_load / self.b.peak_load - 1.0

    @property
    def peak_shift(self) -> float:
        """How much later, in opening over that of B, the peak of A comes."""
        return ratio(self.a.peak_opening - self.b.peak_opening, self.b.peak_opening)

    @property
    def energy_difference(self) -> float:
        return ratio(self.a.work - self.b.work, abs(self.b.work))

    @property
    def worst(self) -> tuple[float, float, float]:
        """Opening at which the loads differ most, load of A and of B there."""
        with np.errstate(all="ignore"):
            i = int(np.argmax(np.abs(self.load_a_n - self.load_b_n)))
        return float(self.opening_n[i]), float(self.load_a_n[i]), float(self.load_b_n[i])

    def agrees(self, curve: float | None = None, peak: float | None = None, energy: float | None = None) -> bool:
        """Whether A is within the given relative tolerances of B, at least one; see `checks`."""
        found = checks(self, curve, peak, energy)
        if not found:
            raise TypeError("agrees needs a tolerance: curve, peak or energy")
        return all(check.passed for check in found)

    @property
    def _in_short(self) -> dict[str, str]:
        """The differences of A in words, by their names."""
        at, P_a, P_b = self.worst
        parts = {
            "peak load": self.peak_difference,
            "energy": self.energy_difference,
            f"largest deviation (at {at:.4g})": ratio(P_a - P_b, abs(P_b)),
        }
        return {"curve error": f"{100 * self.curve_error:.3g} %"} | {
            name: f"{100 * part:+.3g} %" for name, part in parts.items()
        }

    def __repr__(self) -> str:
        numbers = ", ".join(f"{name} {value}" for name, value in self._in_short.items())
        return f"<Comparison: {self.names[0]} against {self.names[1]}, {numbers}>"

    def _repr_html_(self) -> str:
        from iga.notebook import Drawn, chart, table

        (a, b), A, B = self.names, self.a, self.b
        curves = Drawn(a, A.opening, A.load), Drawn(b, B.opening, B.load, behind=True)
        return chart(curves) + table(["", f"{a} against {b}"], self._in_short.items())

    def loads_at(self, openings: Sequence[float]) -> list[tuple[float, float, float]]:
        """Opening, load of A and load of B, on the envelopes.

        Raises
        ------
        CurveError : an opening outside (begin, end].
        """
        outside = [at for at in openings if not self.begin < at <= self.end]
        if outside:
            reach = f"> {self.begin:.6g} and <= {self.end:.6g}, the end of the comparison"
            raise CurveError(f"at: must be {reach}, got {outside[0]:g}")
        with np.errstate(all="ignore"):
            loads = [load_at((part.opening, part.load), openings).tolist() for part in (self.a, self.b)]
        return list(zip(openings, *loads, strict=True))


def compare(
    a: Points,
    b: Points,
    end: float | None = None,
    names: tuple[str, str] = ("A", "B"),
    begin: float | None = None,
    programme: Sequence[float] | None = None,
) -> Comparison:
    """Hold A against B over the openings that both reach, from ``begin`` on and up to ``end``.

    Without them from 0, and to the last opening of B. A path is compared from its first arrival at ``begin``.
    Where the load ``programme`` turns, its legs are compared as well; without it the turns are those of B, see
    `verify.curves.legs.programme_of`.

    A curve that begins at an opening above 0 is joined to the origin by a straight line: there the specimen bears
    nothing, and a beginning that is left out shows as an error.

    Raises
    ------
    CurveError : ``end`` beyond B, ``begin`` not before the end, nothing in common, no load of B above 0, or a
        ``programme`` with one of both, or one that B does not follow.
    """
    if begin is not None and not 0.0 <= begin < np.inf:
        raise CurveError(f"begin: must be >= 0, got {begin:g}")
    (first_a, last_a), (first_b, last_b) = ((float(d[0]), float(np.max(d))) for d, _ in (a, b))
    asked = last_b if end is None else float(end)
    if not 0.0 < asked <= last_b * (1.0 + SAME_TURN):
        raise CurveError(f"end: must be > 0 and <= {last_b:.6g}, the last opening of {names[1]}, got {asked:g}")
    common, begin = min(asked, last_a, last_b), float(begin or 0.0)
    if begin >= common:
        raise CurveError(f"begin: must be < {common:.6g}, the end of the comparison, got {begin:g}")
    if max(first_a, first_b) >= common:
        ranges = f"{first_a:.6g} to {last_a:.6g} and {first_b:.6g} to {min(asked, last_b):.6g}"
        raise CurveError(f"{' and '.join(names)}: must have openings in common, got {ranges}")
    with np.errstate(all="ignore"):  # numbers near the ends of the range end as inf or NaN, and so fail
        part_a, part_b = _part(a, begin, common), _part(b, begin, common)
        top = part_b.peak_load
        if not top > 0.0:
            span = f"up to {common:.6g}" if begin == 0.0 else f"from {begin:.6g} to {common:.6g}"
            way = "; a scale of -1 turns signs" if part_b.load.min() < 0.0 else ""
            raise CurveError(f"{names[1]}: the loads {span} must go above 0, got at most {top + 0.0:g}{way}")
        grid = samples(begin, common)
        load_a, load_b = (load_at((part.opening, part.load), grid) for part in (part_a, part_b))
        one, other = ((part.opening, part.load / top) for part in (part_a, part_b))
        error = curve_error(one, other, common, begin)
        wave = _wave(*((part_a, part_b) if begin == 0.0 else (_part(a, 0.0, common), _part(b, 0.0, common))))
        cut = end is not None or begin > 0.0
        way_a, way_b = ((part.opening, part.load) if cut else from_origin(*c) for part, c in ((part_a, a), (part_b, b)))
        paths = _paths(way_a, way_b, names[1], programme, cut)
    return Comparison(part_a, part_b, asked, common, error, *wave, grid, load_a, load_b, names, begin, paths)


def checks(
    comparison: Comparison, curve: float | None = None, peak: float | None = None, energy: float | None = None
) -> list[Check]:
    """The checks of the given relative tolerances; with any of them also that A reaches the end of the comparison.

    That of the curve applies to every leg of a programme that turns, and `OF_A_POINT` times it to every point of A.
    """
    near = TURN_TOLERANCE if curve is None else min(TURN_TOLERANCE, max(SAME_TURN, OF_AN_END * curve))
    rows: list[tuple[str, float, float | None, str]] = [
        ("curve-error", comparison.curve_error, curve, "relative L2 distance of the loads over the opening"),
        ("peak-load", comparison.peak_difference, peak, "difference of the peak loads over that of B"),
        ("energy", comparison.energy_difference, energy, "difference of the works along the path over that of B"),
    ]
    if all(limit is None for _, _, limit, _ in rows):
        return []
    (a, b), (name, other), legs = comparison.paths, comparison.names, comparison.legs
    if curve is not None:
        worst = farthest(a, b, OF_A_POINT * curve, every_point=False)
        if worst is not None:
            text = f"distance of the farthest point of {name}, at opening {worst.opening:.6g}, from {other}"
            rows.append(("farthest-point", worst.value, OF_A_POINT * curve, text))
        if legs:
            goals = ", ".join(f"{leg.end:g}" for leg in b.legs)
            text = f"distance of the turns of {name} from those of {other}, {goals}, over the largest opening"
            rows.append(("legs", a.misfit, near, text))
    found = [Check(key, "A / B", v, limit, "cross-code", text) for key, v, limit, text in rows if limit is not None]
    along = () if curve is None else leg_checks(legs, "A / B", curve)
    far = "share of the opening that A does not reach"
    return [*found, *along, Check("end", "A / B", comparison.missing, near, "cross-code", far)]


def _paths(a: Points, b: Points, name: str, programme: Sequence[float] | None, cut: bool) -> tuple[Path, Path]:
    """Both curves along the programme that is given, or along that of B."""
    if programme is None:
        way = programme_of(b)
        there = path(b, way)
        return (path(a, way), there) if there.complete else (path(a, way[-1:]), path(b, way[-1:]))
    goals = [float(goal) for goal in programme]
    still = any(here == goal for here, goal in zip([0.0, *goals], goals, strict=False))
    if not goals or still or not np.all(np.isfinite(goals)):
        raise CurveError(f"programme: must be openings, each different from the one before it, got {goals}")
    if cut:
        raise CurveError("programme: must be left out with a begin or an end")
    there = path(b, goals)
    if not there.complete:
        listed = ", ".join(f"{goal:g}" for goal in turns(goals))
        raise CurveError(f"programme: {name} must turn, and end, at {listed}; it does not where {there.legs[-1].words}")
    return path(a, goals), there


def _part(curve: Points, begin: float, end: float) -> Part:
    first, last = float(curve[0][0]), float(np.max(curve[0]))
    d, P = _up_to(*from_origin(*curve), end)
    if begin > 0.0:
        before, start = _up_to(d, P, begin)
        d, P = np.append(begin, d[len(before) - 1 :]), np.append(start[-1], P[len(before) - 1 :])
    at, load = peak(envelope(d, P))
    work = float(np.sum((P[1:] / 2.0 + P[:-1] / 2.0) * np.diff(d)))
    return Part(d, P, first, last, at, load, work)


def _up_to(d: np.ndarray, P: np.ndarray, end: float) -> Points:
    """The path until it first comes to the opening ``end``, which it reaches."""
    i = int(np.argmax(d >= end))
    share = (end - d[i - 1]) / (d[i] - d[i - 1])
    load = P[i - 1] + share * (P[i] - P[i - 1])
    return np.append(d[:i], end), np.append(P[:i], load)


def _wave(a: Part, b: Part) -> tuple[float, float]:
    """Oscillation of A about B, over the last opening and the peak load of B, where both have enough points."""
    end, size = float(b.opening.max()), b.peak_load
    one, other = ((part.opening / end, part.load / size) for part in (a, b))
    points = min(np.count_nonzero(envelope(*c)[0] > PROPAGATION * b.peak_opening / end) for c in (one, other))
    found = oscillation(one, other, end=1.0) if points >= POINTS_OF_A_WAVE else {}
    return found.get("rms", np.nan), found.get("excess_variation", np.nan)


def ratio(value: float, reference: float) -> float:
    return value / reference if reference else 0.0 if value == 0.0 else np.nan
