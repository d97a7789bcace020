"""The law of the solvers as a function of one point, step by step."""

from __future__ import annotations

from typing import Any

import numpy as np

from verify.methods.mixed import iga_law, modelled_law
from verify.studies.law.given.answer import PointLaw
from verify.studies.law.opening_bond import OpeningBond
from verify.theory.mixed_law import MixedBond


def built_in(bond: MixedBond) -> PointLaw:
    """The law of ``iga`` with the numbers of a bond, with its tangent."""
    found = iga_law(bond)

    def law(g: float, s: float, state: Any, dt: float) -> tuple:
        history = found.start(1) if state is None else state
        at = found.traction(np.array([g]), np.array([s]), history, dt)
        tangent = ((at.dp_dg[0], at.dp_ds[0]), (at.dt_dg[0], at.dt_ds[0]))
        return at.p[0], at.t[0], at.history, tangent

    return law


def opening_law(bond: MixedBond) -> PointLaw:
    """The mode I law of ``iga`` with the numbers of a bond; sliding costs nothing there."""
    from iga.interface.laws import LAWS

    (p, _), (G, _), (K, _) = bond.strength, bond.toughness, bond.slopes
    own: dict[str, Any] = {"plateau": bond.plateau} if bond.law == "trapezoidal" else {}
    if isinstance(bond, OpeningBond):
        own = {"table": tuple(map(tuple, bond.envelope.corners.tolist()))}
    found = LAWS[bond.law](p, G, 2.0 * G * K / p**2, bond.penalty, bond.contact, **own)

    def law(g: float, s: float, state: Any, dt: float) -> tuple:
        traction, slope, k = found.traction(np.array([g]), np.zeros(1) if state is None else state)
        return traction[0], 0.0, k, ((slope[0], 0.0), (0.0, 0.0))

    return law


def modelled(bond: MixedBond) -> PointLaw:
    """The law of ``fem_reference`` with the numbers of a bond."""
    found = modelled_law(bond)

    def law(g: float, s: float, state: Any, dt: float) -> tuple:
        d, slip = (np.zeros(1), np.zeros(1)) if state is None else state
        p, t, tangent, d, slip = found.traction(np.array([g]), np.array([s]), d, slip, dt)
        return p[0], t[0], (d, slip), tangent[0]

    return law
