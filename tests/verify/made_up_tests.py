"""Curves of delamination tests by fracture mechanics, as a laboratory would record them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from verify.reduction.coupon import Coupon, coupon
from verify.reduction.data import Measured
from verify.reduction.flexure import flexure
from verify.scene.load import load_scene

#: Kind -> scene, toughness, and the crack length at the end.
TESTS = {
    "dcb": ("dcb-as4peek", 0.969, 75.0),
    "enf": ("enf-as4peek", 1.719, 47.0),
    "4enf": ("4enf", 1.719, 80.0),
    "mmb": ("mmb50-as4peek", 1.1, 46.0),
}


@dataclass(frozen=True)
class Rig:
    """What a laboratory adds to a curve; by default nothing."""

    rows: int = 2000
    noise: float = 0.0  # of the load, in parts of the largest
    machine: float = 0.0
    toe: float = 0.0
    readings: int = 20
    jitter: float = 0.0  # of a crack length that is read
    modulus: float = 1.0  # over that of the scene
    seed: int = 0


NOISY = Rig(rows=5000, noise=0.003, machine=1e-4, toe=0.3, jitter=0.3, modulus=0.97)


def specimen(kind: str) -> Coupon:
    return coupon(load_scene(TESTS[kind][0]))


def recorded(kind: str, rig: Rig) -> Measured:
    """A crack that grows at constant toughness along the closed form of the specimen, under a growing opening.

    The toe is a soft start up to 15 % of the largest load, after which the curve is as it would be, shifted.
    """
    of, (_, toughness, end), random = specimen(kind), TESTS[kind], np.random.default_rng(rig.seed)
    beam, E = flexure(of), of.young * rig.modulus
    a = np.linspace(of.precrack, end, 4000)
    P = np.sqrt(toughness / np.sum(beam.release(1.0, a, E), axis=0))
    d = (beam.compliance(a, E) + rig.machine) * P
    assert (np.diff(d) > 0.0).all(), "the crack runs away"
    x = np.linspace(0.0, d[-1], rig.rows)
    load, crack = (np.interp(x, np.append(0.0, d), np.append(first, y)) for first, y in ((0.0, P), (of.precrack, a)))
    opening = x + rig.toe * (1.0 - np.clip(1.0 - load / (0.15 * load.max()), 0.0, 1.0) ** 2)
    read = np.full(rig.rows, np.nan)
    grown = np.flatnonzero(crack > of.precrack * (1.0 + 1e-6))
    at = grown[np.linspace(0.02 * grown.size, grown.size - 1, rig.readings).astype(int)]
    read[at] = np.maximum(crack[at] + rig.jitter * random.standard_normal(at.size), 1.001 * of.precrack)
    return Measured("test", opening, load + rig.noise * load.max() * random.standard_normal(rig.rows), read)


def text_of(test: Measured, header: str = "opening,load,a") -> str:
    """As a CSV file, with crack lengths where they were read."""
    rows = zip(test.opening.tolist(), test.load.tolist(), test.crack.tolist(), strict=True)
    lines = [f"{d:.9g},{P:.9g},{'' if a != a else f'{a:.9g}'}" for d, P, a in rows]
    return "\n".join([header, *lines]) + "\n"
