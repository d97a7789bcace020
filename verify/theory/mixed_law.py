"""Laws of a bond that opens and slides, along whole paths at once; independent of those of the solvers on purpose.

With the jump (g, s), stiffness (K, Ks), g+ = max(g, 0), and one damage d for both tractions:

    lambda^2 = K g+^2 + Ks s^2,  B = Ks s^2 / lambda^2          (energy norm and mode ratio by energy)
    p = (1 - d) K g, in contact penalty g where g < 0;  t = (1 - d) Ks s + a t_f with friction t_f

Sources: Camanho and Davila (2002), NASA/TM-2002-211737 (one damage, mode ratio); Benzeggagh and Kenane (1996), Compos.
Sci. Technol. 56 (toughness); Turon et al. (2006), Mech. Mater. 38 (onset); Turon et al. (2010), Eng. Fract. Mech. 77
(stiffness); Alfano and Sacco (2006), Int. J. Numer. Methods Eng. 68 (friction); Salehani and Irani (2018), the
exponential law.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import hyperu

from verify.support.refusal import Refusal
from verify.theory.bond import Bond
from verify.theory.mixed_path import Path, accumulated, damage_history, slip_history, steps_in_time
from verify.theory.shapes import KNOWN_SHAPES, Shape

#: Laws of opening and sliding.
KNOWN_MIXED_LAWS = (*KNOWN_SHAPES, "exponential")
#: Criterion of the toughness -> onsets that go with it, the default first.
ONSETS_OF = {"bk": ("turon", "quadratic"), "power": ("quadratic",)}
#: What friction acts on.
RUBBING = ("damage", "area")
#: Progress of the exponential law, which never fails, that counts as failure: 2e-4 of the toughness left.
PRACTICALLY_FAILED = 8.0


@dataclass(frozen=True)
class MixedBond(Bond):
    """A `Bond` with both modes and what follows from its numbers. Parameters, besides or more closely:

    law : one of `KNOWN_MIXED_LAWS`; what a table says of strength and toughness counts for its shape alone
    stiffness : the exponential law has its own, whatever is given: `slopes`
    criterion : "bk", G_c = G_I + (G_II - G_I) B^a, or "power", 1/G_c = [((1-B)/G_I)^a + (B/G_II)^a]^(1/a)
    exponent : a >= 1
    onset : "turon", lambda0^2 = p_max^2/K + (t_max^2/Ks - p_max^2/K) B^a, with "bk" alone and its default; or
        "quadratic", 1/lambda0^2 = (1-B) K/p_max^2 + B Ks/t_max^2, the default with "power"
    pressure_strength : c; under a contact pressure q the strength is t_max + c q, the toughness G_II. The strength ends
        where the elastic energy at onset is the toughness: there the bond is brittle
    rubs : the part a of the bond that friction acts on: "damage", a = d (Alfano and Sacco), or "area", the part of the
        way from onset to failure in pure sliding that has the damage d (CompDam), of laws that fall along a line

    The exponential law has no criterion and no onset: p = e p_max x exp(-x - y^2), t = sqrt(2 e) t_max y exp(-x - y^2)
    with x = g+ / g0, y = s / s0, g0 = G_I / (e p_max), s0 = sqrt(2/e) G_II / t_max.

    Raises
    ------
    Refusal : a parameter outside its range, or a stiffness so low that a point would fail before its onset
    """

    strength: tuple[float, float]
    toughness: tuple[float, float]
    stiffness: tuple[float, float]

    def __post_init__(self) -> None:
        if fault := next(_faults(self), ""):
            raise Refusal(fault)

    @property
    def onset_rule(self) -> str:
        """The onset that holds: the given one, or the default of the criterion."""
        return self.onset or ONSETS_OF[self.criterion][0]

    @property
    def of_criterion(self) -> bool:
        """Whether damage grows from an onset until a criterion's toughness is taken up."""
        return self.law != "exponential"

    @property
    def slopes(self) -> tuple[float, float]:
        """Initial slopes (K, Ks): as given; of the exponential law (e p_max)^2 / G_I and e t_max^2 / G_II."""
        if self.law != "exponential":
            return self.stiffness
        return (np.e * self.strength[0]) ** 2 / self.toughness[0], np.e * self.strength[1] ** 2 / self.toughness[1]

    @property
    def scale(self) -> np.ndarray:
        """Jumps in opening and in sliding of the size at which damage begins."""
        return np.array(self.strength) / np.array(self.slopes)

    def mode_ratio(self, g: ArrayLike, s: ArrayLike) -> np.ndarray:
        """B, the part of sliding in the elastic energy; 0 where nothing has moved."""
        sliding, norm = np.sqrt(self.slopes[1]) * np.abs(s), self.energy_norm(g, s)
        return np.divide(sliding, norm, out=np.zeros_like(norm), where=norm > 0.0) ** 2

    def energy_norm(self, g: ArrayLike, s: ArrayLike) -> np.ndarray:
        """Lambda, the square root of twice the elastic energy of the intact bond, without that of contact."""
        K, Ks = self.slopes
        return np.asarray(np.hypot(np.sqrt(K) * np.maximum(g, 0.0), np.sqrt(Ks) * np.asarray(s, dtype=float)))

    def onset_norm(self, B: ArrayLike) -> np.ndarray:
        """Lambda0 at which damage begins without pressure; 0 for the exponential law."""
        B = np.asarray(B, dtype=float)
        if self.law == "exponential":
            return np.zeros_like(B)
        normal, shear = (strength**2 / k for strength, k in zip(self.strength, self.stiffness, strict=True))
        if self.onset_rule == "turon":
            return np.sqrt(normal + (shear - normal) * B**self.exponent)
        return 1.0 / np.sqrt((1.0 - B) / normal + B / shear)

    def critical(self, B: ArrayLike) -> np.ndarray:
        """G_c, the energy that a path of constant mode ratio takes up; of the exponential law in closed form."""
        if self.law != "exponential":
            return self.by_criterion(B)
        B, (G_I, G_II) = np.asarray(B, dtype=float), self.toughness
        # integral of lambda exp(-a lambda - b^2 lambda^2): x = a lambda and y = b lambda on a ray; b = 0 is a limit
        a = np.sqrt((1.0 - B) / G_I)
        b = np.maximum(np.sqrt(B / (2.0 * G_II)), 1e-9 * a)
        return hyperu(1.0, 0.5, (a / (2.0 * b)) ** 2) / (4.0 * b**2)

    def by_criterion(self, B: ArrayLike) -> np.ndarray:
        """G_c of the criterion, which the exponential law does not keep."""
        B, (G_I, G_II) = np.asarray(B, dtype=float), self.toughness
        if self.criterion == "bk":
            return G_I + (G_II - G_I) * B**self.exponent
        a = self.exponent
        return (((1.0 - B) / G_I) ** a + (B / G_II) ** a) ** (-1.0 / a)

    @cached_property
    def shape(self) -> Shape:
        return KNOWN_SHAPES[self.law](self)

    @property
    def steepness(self) -> float:
        """See `Shape`; 1 of the exponential law, which has none."""
        return 1.0 if self.law == "exponential" else self.shape.steepness

    def corners(self, B: ArrayLike, pressure: ArrayLike = 0.0) -> tuple[np.ndarray, ...]:
        """Sizes lambda of jumps at a mode ratio B and a contact pressure: at onset, at the corners of the shape, and at
        failure. The exponential law has none."""
        G_c = self.critical(B)
        rise = 1.0 + self.pressure_strength * np.asarray(pressure) / self.strength[1]
        onset = np.minimum(self.onset_norm(B) * rise, np.sqrt(2.0 * G_c))
        way = (2.0 * G_c - onset**2) / (2.0 * self.shape.area * onset)  # with which the area is G_c
        return (onset, *(onset + x * way for x in self.shape.corners[1:]))

    def driving(self, g: ArrayLike, s: ArrayLike) -> np.ndarray:
        """D, the damage that the jump asks for on its own, 0 to 1."""
        g, s = np.broadcast_arrays(np.asarray(g, dtype=float), np.asarray(s, dtype=float))
        if self.law == "exponential":
            e, (p_max, t_max), (G_I, G_II) = np.e, self.strength, self.toughness
            return -np.expm1(-np.maximum(g, 0.0) * e * p_max / G_I - (s * t_max / G_II) ** 2 * e / 2.0)
        norm = self.energy_norm(g, s)
        onset, *_, end = self.corners(self.mode_ratio(g, s), self.pressure(g))
        beyond = norm > onset
        to_go = np.divide(end - norm, end - onset, out=np.zeros_like(norm), where=end > onset)  # of a brittle bond 0
        part = np.divide(onset, norm, out=np.ones_like(norm), where=beyond) * self.shape.left(to_go)
        return np.where(beyond, 1.0 - part, 0.0)

    def progress(self, g: ArrayLike, s: ArrayLike) -> np.ndarray:
        """How far a jump is on its own: 1 where damage begins, 2 where the bond fails, beyond at the same rate."""
        norm, B = self.energy_norm(g, s), self.mode_ratio(g, s)
        if self.law == "exponential":
            return 1.0 + norm / np.sqrt(self.critical(B)) / PRACTICALLY_FAILED
        onset, *_, end = self.corners(B)
        return np.where(norm <= onset, norm / onset, 1.0 + (norm - onset) / (end - onset))

    def pressure(self, g: ArrayLike) -> np.ndarray:
        """Contact pressure q, 0 where the bond is open or knows no contact (stress)."""
        return np.maximum(-self.penalty * np.asarray(g, dtype=float), 0.0) * self.contact

    def rubbing_part(self, d: ArrayLike) -> np.ndarray:
        """The part a of the bond that friction acts on at a damage d."""
        d = np.asarray(d, dtype=float)
        if self.rubs == "damage":
            return d
        onset, end = self.strength[1] / self.stiffness[1], 2.0 * self.toughness[1] / self.strength[1]
        return d * onset / (d * onset + (1.0 - d) * end)  # (s - onset) / (end - onset) of the bilinear law

    def path(self, g: ArrayLike, s: ArrayLike, time: ArrayLike | None = None) -> Path:
        """Tractions, histories and energies at the points (n,) of a path from rest, ``time`` from 0 to 1 by default.

        The energies lost are sums over the steps, of second order in their length (`accumulated`): released with each
        dd is (K g+^2 + Ks s^2)/2, without contact g^2 in place of g+^2, less Ks (s - s_p)^2/2 with each da where there
        is friction; rubbed with each |ds_p| is a mu q, for slip moves at the limit of friction alone.

        Raises `Refusal` for arrays that are no numbers or of other lengths, and for times that decrease.
        """
        g, s = (np.asarray(a, dtype=float) for a in (g, s))
        if g.ndim != 1 or g.shape != s.shape or not np.all(np.isfinite([g, s])):
            raise Refusal(f"path: g and s must be finite numbers, as many of each, got shapes {g.shape} and {s.shape}")
        dt = steps_in_time(None if time is None else np.asarray(time), g.size)
        d = damage_history(self.driving(g, s), dt, self.viscosity, self.irreversible)
        K, Ks = self.slopes
        limit = self.friction * self.pressure(g)
        slip = slip_history(s, limit / Ks) if self.friction > 0.0 else np.zeros_like(s)
        rubs = self.rubbing_part(d) * (self.friction > 0.0)
        t_f = np.clip(Ks * (s - np.append(0.0, slip[:-1])), -limit, limit)
        held = 0.5 * Ks * (s - slip) ** 2
        closed = (g < 0.0) & self.contact
        elastic = 0.5 * (K * np.where(closed, 0.0, g) ** 2 + Ks * s**2)
        released, rubbed = accumulated(elastic, d), np.zeros_like(s)
        if self.friction > 0.0:
            released = released - accumulated(held, rubs)
            rubbed = accumulated(rubs * limit, np.cumsum(np.abs(np.diff(slip, prepend=0.0))))
        return Path(
            p=np.where(closed, self.penalty, (1.0 - d) * K) * g,
            t=(1.0 - d) * Ks * s + rubs * t_f,
            d=d,
            slip=slip,
            stored=(1.0 - d) * elastic,
            contact=np.where(closed, 0.5 * self.penalty * g**2, 0.0),
            friction_stored=rubs * held,
            released=released,
            rubbed=rubbed,
        )


def _faults(bond: MixedBond) -> Iterator[str]:
    """A sentence for each name that is not known or does not go with the others, and each number outside its range."""
    names: dict[str, Collection[str]] = {"law": KNOWN_MIXED_LAWS, "criterion": ONSETS_OF, "rubs": RUBBING}
    for key, allowed in names.items():
        if getattr(bond, key) not in allowed:
            yield f"{key}: must be one of {', '.join(allowed)}, got {getattr(bond, key)}"
    onsets = ONSETS_OF[bond.criterion]
    if bond.onset is not None and bond.onset not in onsets:
        wish = f"one of {', '.join(onsets)}" if len(onsets) > 1 else onsets[0]
        yield f"onset: must be {wish} with the criterion {bond.criterion}, got {bond.onset}"
    if bond.law == "exponential" and bond.pressure_strength != 0.0:
        yield f"pressure_strength: must be 0 with the exponential law, got {bond.pressure_strength:g}"
    if bond.law == "exponential" and bond.rubs != "damage":
        yield f"rubs: must be damage with the exponential law, got {bond.rubs}"
    positive = {"penalty": bond.penalty}
    for key in ("strength", "toughness", "stiffness"):
        positive |= dict(zip((key, f"shear_{key}"), getattr(bond, key), strict=True))
    for key, value in positive.items():
        if not 0.0 < value < np.inf:
            yield f"{key}: must be > 0, got {value:g}"
    for key, least in (("friction", 0.0), ("viscosity", 0.0), ("pressure_strength", 0.0), ("exponent", 1.0)):
        if not least <= getattr(bond, key) < np.inf:
            yield f"{key}: must be >= {least:g}, got {getattr(bond, key):g}"
    if not bond.of_criterion:
        return
    assert bond.shape  # raises a refusal of its own
    B = np.linspace(0.0, 1.0, 1001)
    stored, toughness = 0.5 * bond.onset_norm(B) ** 2, bond.critical(B)
    worst = int(np.argmax(stored / toughness))
    if stored[worst] >= toughness[worst]:
        yield (
            f"stiffness: must store less at the onset of damage than the toughness, got {stored[worst]:.6g} of "
            f"{toughness[worst]:.6g} at the mode ratio {B[worst]:g}"
        )
