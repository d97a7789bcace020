"""The toughness of a law between the modes, from the law itself, beside the one that the criterion of its bond says."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from verify.theory.mixed_law import MixedBond


@dataclass(frozen=True)
class Rays:
    """Paths of constant mode ratio on which a law is integrated.

    ratios : number of mode ratios, equally spaced from 0 to 1
    steps : steps of the finer one of two sums; the other one takes every second step
    graded : exponent by which steps are shorter near rest, where a stiff bond has its onset
    sure : factor on the difference of both sums that bounds the error of the finer one. Kinks of a law leave an error
        of second order, which falls by 4 on average and by less where a kink is near a step
    """

    ratios: int = 101
    steps: int = 2000
    graded: float = 4.0
    sure: float = 3.0


RAYS = Rays()


@dataclass(frozen=True)
class Toughness:
    """Toughness (n,) over the mode ratios ``B`` (n,), of the law by integration and of the criterion [energy per area].

    ``error`` (n,) bounds that of the integration.
    """

    B: np.ndarray
    law: np.ndarray
    criterion: np.ndarray
    error: np.ndarray


def toughness(bond: MixedBond) -> Toughness:
    """The work of a path of constant mode ratio from rest to failure, ``int (1 - D) lambda d lambda``.

    In such a path the tractions are (1 - D) K g and (1 - D) Ks s, and B = G_II / G of the work as well.
    """
    (K, Ks), B = bond.slopes, np.linspace(0.0, 1.0, RAYS.ratios)
    end, way = 2.0 * np.sqrt(bond.by_criterion(B)), np.linspace(0.0, 1.0, RAYS.steps + 1)[:, None] ** RAYS.graded

    def carried(size: np.ndarray) -> np.ndarray:
        """(1 - D) lambda at jumps of a size lambda (..., n)."""
        return size * (1.0 - bond.driving(size * np.sqrt((1.0 - B) / K), size * np.sqrt(B / Ks)))

    while (left := carried(end) * end > 1e-15 * bond.by_criterion(B)).any():
        end = np.where(left, 2.0 * end, end)
    traction, size = carried(way * end), way * end
    fine, coarse = (np.trapezoid(traction[::n], size[::n], axis=0) for n in (1, 2))
    return Toughness(B, fine, bond.by_criterion(B), RAYS.sure * np.abs(fine - coarse))


def off_criterion(bond: MixedBond) -> tuple[str, ...]:
    """A sentence where the toughness of a law differs from its criterion by more than the error of the integration."""
    found = toughness(bond)
    apart = np.abs(found.law / found.criterion - 1.0)
    at = int(np.argmax(apart))
    if apart[at] <= float(np.max(found.error / found.criterion)):
        return ()
    law, said = found.law[at], found.criterion[at]
    return (
        f"interface.law: the toughness of the {bond.law} law is {law:.3g} at G_II/G = {found.B[at]:.2g}, where the "
        f"criterion, {bond.criterion} of exponent {bond.exponent:g}, has {said:.3g}: "
        f"{100.0 * (law / said - 1.0):+.2g} %, the largest difference; a crack grows at the toughness of the law",
    )
