"""The linear part of a curve: stiffness, toe, and the compliance of the machine."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from verify.reduction.data import Measured
from verify.support.refusal import Refusal


@dataclass(frozen=True)
class Smoothing:
    """How noise is told from the curve.

    ``quiet`` is the noise of the load, in parts of its largest value, below which nothing is smoothed; ``parts`` the
    number of windows in the curve, where fewer smooth more and round the peak off.
    """

    quiet: float = 2e-4
    parts: int = 400


SMOOTHING = Smoothing()


@dataclass(frozen=True)
class LinearPart:
    """``opening = toe + C P`` between two loads, by least squares of the load on the opening.

    The load carries the noise, as a test prescribes the opening. ``noise`` is the standard deviation of the load.
    """

    compliance: float
    toe: float
    noise: float
    rows: np.ndarray  # indices


@dataclass(frozen=True)
class Smoothed:
    """Rows whose load, and J, is the mean of ``width`` neighbours, and the standard deviation of the load's noise."""

    rows: Measured
    noise: float
    width: int

    @property
    def uncertainty(self) -> float:
        """Standard deviation of a smoothed load."""
        return self.noise / self.width**0.5


def noise_of(values: np.ndarray) -> float:
    """Standard deviation of values by their second differences, 1.4826 MAD / sqrt(6).

    Of means of neighbouring rows it holds what scatters over the lengths of their groups, such as stick and slip.
    """
    return 1.4826 * float(np.median(np.abs(np.diff(values, 2)))) / 6.0**0.5 if values.size > 2 else float("nan")


def smooth(measured: Measured) -> Smoothed:
    """A moving mean where the load is noisy (`noise_of`)."""
    P = measured.load
    if measured.virtual or P.size < 5:
        return Smoothed(measured, 0.0, 1)
    noise = noise_of(P)
    width = 2 * (P.size // SMOOTHING.parts // 2) + 1
    if noise < SMOOTHING.quiet * P.max():
        width = 1
    J = None if measured.J is None else _mean(measured.J, width)
    return Smoothed(replace(measured, load=_mean(P, width), J=J), noise, width)


def _mean(values: np.ndarray, width: int) -> np.ndarray:
    """Means (n,) of ``width`` neighbours, an odd number."""
    padded = np.pad(values, width // 2, mode="edge")
    return np.convolve(padded, np.full(width, 1.0 / width), mode="valid")


def fitted_line(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """Slope and intercept of y over x by least squares."""
    centred = x - x.mean()
    slope = float(centred @ y) / float(centred @ centred)
    return slope, float(y.mean() - slope * x.mean())


def linear_rows(smoothed: np.ndarray, window: tuple[float, float], source: str) -> np.ndarray:
    """Indices of the rows from the first load of ``window[0]`` times the largest one to the first of ``window[1]``.

    Raises
    ------
    Refusal : fewer than 3 rows.
    """
    top = int(np.argmax(smoothed))
    rise = smoothed[: top + 1]
    first, last = (int(np.argmax(rise >= part * smoothed[top])) for part in window)
    if last - first < 2:
        low, high = (100 * part for part in window)
        way = "; --linear LOW,HIGH chooses other parts" if top > 1 else ""
        raise Refusal(
            f"{source}: must have at least 3 points from {low:g} to {high:g} % of the largest load, "
            f"{smoothed[top]:.4g} in point {top + 1}, got {last - first + 1}{way}"
        )
    return np.arange(first, last + 1)


def line(measured: Measured, rows: np.ndarray) -> LinearPart:
    """Stiffness and origin of the linear part.

    Raises
    ------
    Refusal : the load does not grow there.
    """
    d, P = measured.opening[rows], measured.load[rows]
    stiffness, at_zero = fitted_line(d, P) if np.ptp(d) > 0.0 else (0.0, 0.0)
    if not stiffness > 0.0:
        raise Refusal(f"{measured.source}: the load must grow with the opening in the linear part, got {stiffness:g}")
    left = P - at_zero - stiffness * d
    noise = float(np.sqrt(left @ left / max(rows.size - 2, 1)))
    return LinearPart(1.0 / stiffness, 0.0 - at_zero / stiffness, noise, rows)


def corrected(measured: Measured, part: LinearPart, toe: bool, machine: float) -> tuple[Measured, LinearPart]:
    """The rows with ``opening - toe - machine P``, and their linear part.

    Toe: the origin is moved to where the linear part meets the axis (ASTM D7905, D5528). Machine: its compliance comes
    from a test of a stiff block (ISO 15024, annex B).

    Raises
    ------
    Refusal : the machine is as compliant as machine and specimen together.
    """
    if machine >= part.compliance:
        raise Refusal(
            f"--machine-compliance: must be less than that of machine and specimen together, "
            f"{part.compliance:.6g} by the linear part, got {machine:g}"
        )
    shift = part.toe if toe else 0.0
    opening = measured.opening - shift - machine * measured.load
    return replace(measured, opening=opening), replace(part, compliance=part.compliance - machine, toe=part.toe - shift)
