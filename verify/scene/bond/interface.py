"""The table ``[interface]`` of a scene: a traction law for opening, and with the keys of shear for sliding as well.

``shear_strength`` and ``shear_toughness`` switch sliding on; the keys below them require these two.
The corners of a tabular law are pairs of opening and traction, with its strength and toughness.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain, pairwise
from math import e
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    SerializerFunctionWrapHandler,
    field_validator,
    model_serializer,
    model_validator,
)

from verify.scene.laws import EXPONENTIAL, OWN_KEYS, PLAIN, TABULAR, known, mixed
from verify.scene.tables import MISSING, Broken, Positive, Section, refuse
from verify.support.refusal import one_of

#: What a table must be, in the words of a refusal.
CORNERS = "a list of two or more corners [opening, traction]"

_Pairs: TypeAlias = Sequence[Sequence[float]]


def _as_pairs(value: object) -> object:
    """Lists of lists as tuples; none at all stands for no table."""
    if value == ():
        return value
    if not isinstance(value, list | tuple) or len(value) < 2:
        raise refuse(CORNERS, ((), value))
    odd = [((i,), one) for i, one in enumerate(value) if not isinstance(one, list | tuple) or len(one) != 2]
    if odd:
        raise refuse("a corner [opening, traction]", *odd)
    return tuple(tuple(one) for one in value)


def _of_a_law(table: _Pairs) -> _Pairs:
    """Refuse a table that is not the envelope of a law with damage, whose secants must fall."""
    for i, (opening, traction) in enumerate(table):
        before, held = table[i - 1] if i else (0.0, 0.0)
        if opening <= before:
            raise refuse(f"> {before:g}, the opening before it" if i else "> 0", ((i, 0), opening))
        if i == len(table) - 1:
            if traction != 0:
                raise refuse("0, at the end of the law", ((i, 1), traction))
        elif traction <= 0:
            raise refuse("> 0, up to the last corner", ((i, 1), traction))
        elif i and traction >= opening * held / before:
            rule = f"< {opening * held / before:g}, as traction over opening falls from corner to corner"
            raise refuse(rule, ((i, 1), traction))
    return table


#: The type of the key; empty where it is left out.
Corners: TypeAlias = Annotated[tuple[tuple[float, float], ...], BeforeValidator(_as_pairs), AfterValidator(_of_a_law)]


def stiffness_of(table: _Pairs) -> float:
    """Slope of the first line [stress per length]."""
    opening, traction = table[0]
    return traction / opening


def numbers_of(value: Any) -> dict[str, float]:
    """Strength and toughness of a table; 1.0 for each if it is not valid, as its key is refused anyway."""
    try:
        table = [(float(opening), float(traction)) for opening, traction in value]
        lines = zip([(0.0, 0.0), *table[:-1]], table, strict=True)
        area = sum(0.5 * (g - before) * (held + p) for (before, held), (g, p) in lines)
        numbers = {"strength": max(p for _, p in table), "toughness": area}
    except (TypeError, ValueError, OverflowError):
        return {"strength": 1.0, "toughness": 1.0}
    return {name: number if 0 < number < float("inf") else 1.0 for name, number in numbers.items()}


#: Keys that must be left out without shear_strength and shear_toughness.
ASK_FOR_SHEAR = tuple("criterion exponent onset shear_stiffness friction rubs viscosity pressure_strength".split())
#: Keys that are written down only where a scene gives them.
LEFT_OUT = (*chain(*OWN_KEYS.values()), "stiffness", "shear_strength", "shear_toughness", *ASK_FOR_SHEAR)

#: Criteria of the onset of damage between opening and sliding.
Onset: TypeAlias = Literal["turon", "quadratic"]

#: Allowed relative difference of a strength or toughness that is stated in addition to a table.
AGREES = 1e-6

#: Default of the ductility.
DUCTILITY = 12.5


def bond_stiffness(data: Mapping[str, Any]) -> float:
    """Initial stiffness K [stress per length] from the keys of opening."""
    if data["law"] == EXPONENTIAL:
        return float((e * data["strength"]) ** 2 / data["toughness"])
    if data["stiffness"] is not None:
        return float(data["stiffness"])
    if data["table"]:
        return stiffness_of(data["table"])
    return float(0.5 * data["strength"] ** 2 * data["ductility"] / data["toughness"])


def _ductility(data: dict[str, Any]) -> float:
    """2 K toughness / strength^2 where a key or the law determines K, else the default."""
    said = data["law"] == EXPONENTIAL or data["stiffness"] is not None or data["table"]
    return 2.0 * bond_stiffness(data) * data["toughness"] / data["strength"] ** 2 if said else DUCTILITY


#: Stiffness of the contact over that of the bond.
BOND_TO_CONTACT = 100.0


def _hundred_initial_stiffnesses(data: dict[str, Any]) -> float:
    if data["stiffness"] is not None:
        return BOND_TO_CONTACT * float(data["stiffness"])
    gap_at_strength = 2 * data["toughness"] / data["strength"] / data["ductility"]
    return BOND_TO_CONTACT * data["strength"] / gap_at_strength


def _onset(data: dict[str, Any]) -> Onset:
    return "quadratic" if data["criterion"] == "power" else "turon"


def _consistent(data: dict[str, Any]) -> float | None:
    """Ks with which onset and failure have the same ratio at every mode (Turon et al. 2010), or that of the exponential
    law; None without sliding."""
    strength, toughness = data["shear_strength"], data["shear_toughness"]
    if strength is None or toughness is None:
        return None
    if data["law"] == EXPONENTIAL:
        return float(e * strength**2 / toughness)
    ratio = data["toughness"] / toughness * (strength / data["strength"]) ** 2
    return float(bond_stiffness(data) * ratio)


def _agree(stated: object, own: float) -> bool:
    """Whether a strength or toughness is that of the table."""
    return isinstance(stated, int | float) and abs(stated - own) <= AGREES * own


class Interface(Section):
    law: str = PLAIN
    """Traction over gap, with keys of shear over the effective separation: up to the strength, then down to zero; the
    bilinear one along a line, the trapezoidal one after a plateau, the trilinear one along two lines, the tabular one
    along those of its table, that of exponential softening with a decay; the exponential one (Salehani and Irani) rises
    and falls without an end."""
    plateau: float = Field(default=0.5, ge=0, lt=1)
    """Of the trapezoidal law alone: part of the way from the onset of damage to separation on which the traction
    stays."""
    knee: float = Field(default=0.2, gt=0, lt=1)
    """Of the trilinear law alone: part of the way from the onset of damage to separation after which the slope
    changes."""
    knee_traction: float = Field(default=0.25, gt=0, lt=1)
    """Of the trilinear law alone: part of the traction at onset that is left there."""
    decay: float = Field(default=5.0, ge=0.1, le=100)
    """Of exponential softening alone: a in (exp(-a x) - exp(-a)) / (1 - exp(-a)) on the way x from the onset of damage
    to separation."""
    table: Corners = Field(default=(), examples=[((0.001, 4.0), (0.02, 1.0), (0.08, 0.0))])
    """Of the tabular law alone: its corners, opening [length] and traction [stress] of each. Openings rise, traction
    over opening falls, the last traction is 0; in a bond that slides traction does not rise. Strength and toughness are
    those of the table, and may be left out."""
    strength: Positive
    """Largest traction p_max [stress]."""
    toughness: Positive
    """Work of separation G_Ic [energy per area]."""
    stiffness: float | None = Field(default=None, gt=0, examples=[1e5])
    """Initial stiffness K of the bond [stress per length], in place of the ductility, which is then 2 K toughness /
    strength^2; left out with a law that has its own, the tabular and the exponential one."""
    ductility: float = Field(default_factory=_ductility, gt=1)
    """g_u / g_max, gap at separation over gap at the strength; 1 is a vertical drop, which no Newton follows. Of a law
    that is not bilinear: 2 toughness / strength over the gap at the strength. Left out: 12.5, or what the stiffness or
    the law makes it."""
    penalty: float = Field(default_factory=_hundred_initial_stiffnesses, gt=0)
    """Stiffness of the contact, on closing [stress per length]; left out: 100 times the stiffness of the bond,
    and where arms slide on each other no more than 10 E2 / h, if the bond is softer."""
    shear_strength: float | None = Field(default=None, gt=0, examples=[5.0])
    """Largest traction t_max on sliding [stress]. With shear_toughness it makes a law for opening and sliding; without
    both sliding costs nothing."""
    shear_toughness: float | None = Field(default=None, gt=0, examples=[0.2])
    """Work of separation G_IIc on sliding [energy per area]. The keys below ask for this one and for shear_strength."""
    criterion: Literal["bk", "power"] = "bk"
    """Toughness between opening and sliding: of Benzeggagh and Kenane, or by a power law."""
    exponent: float = Field(default=2.0, ge=1)
    """Of the criterion."""
    onset: Onset = Field(default_factory=_onset, examples=["turon"])
    """Where damage begins between opening and sliding: as Turon et al. (2006), with the exponent of "bk", or where the
    squares of traction over strength add up to 1; left out: "turon" with "bk", "quadratic" with "power"."""
    shear_stiffness: float | None = Field(default_factory=_consistent, gt=0, examples=[781.25])
    """Initial stiffness Ks on sliding [stress per length]; left out: the one for which gaps at separation and at the
    onset are in the same ratio for every mode, K (toughness / shear_toughness) (shear_strength / strength)^2."""
    friction: float = Field(default=0.0, ge=0)
    """Coefficient of friction of the damaged part of the bond, on faces that are pressed together."""
    rubs: Literal["damage", "area"] = "damage"
    """What friction acts on: the damage (Alfano and Sacco 2006), or the part of the area that has failed, which is the
    part of the way from onset to separation in pure sliding."""
    viscosity: float = Field(default=0.0, ge=0)
    """Time in which damage follows, as a part of the duration of the programme; 0: at once."""
    pressure_strength: float = Field(default=0.0, ge=0)
    """Shear strength gained for each unit of pressure on the bond; the toughness stays."""

    @property
    def slides(self) -> bool:
        """Whether the law is one for opening and sliding."""
        return self.shear_strength is not None

    @property
    def bond_stiffness(self) -> float:
        """Initial stiffness K on opening [stress per length]."""
        return bond_stiffness(vars(self))

    @model_validator(mode="before")
    @classmethod
    def _numbers_of_its_table(cls, given: Any) -> Any:
        """Strength and toughness of a tabular law where they are left out, or agree with it."""
        if not isinstance(given, Mapping) or given.get("law") != TABULAR:
            return given
        own = numbers_of(given.get("table"))
        return {**given, **{key: one for key, one in own.items() if key not in given or _agree(given[key], one)}}

    @field_validator("law", mode="before")
    @classmethod
    def _of_some_method(cls, law: object) -> object:
        if law != PLAIN and law not in known():  # `known` imports NumPy, which takes time
            raise refuse(one_of(known()), ((), law))
        return law

    def _broken(self) -> Iterator[Broken]:
        given = {key: value for key in self.model_fields_set if (value := getattr(self, key)) not in (None, ())}
        for key, text in (*self._rules_of_opening(given), *self._rules_of_sliding(given)):
            yield (key,), text, given.get(key, MISSING)

    def _rules_of_opening(self, given: Mapping[str, object]) -> Iterator[tuple[str, str]]:
        """Keys whose values do not go with the others, and what they must be."""
        for own, key in ((law, key) for law, keys in OWN_KEYS.items() for key in keys):
            if key in given and self.law != own:
                yield key, f"left out with the {self.law} law, it is a key of the {own} one"
        if self.law == TABULAR and not self.table:
            yield "table", CORNERS
        for key, number in numbers_of(self.table).items() if self.law == TABULAR and self.table else ():
            if not _agree(getattr(self, key), number):
                yield key, f"{number:.10g} within {AGREES:g} of it, as in interface.table, or left out"
        for key in {"stiffness", "ductility"} & set(given) if self.law in (EXPONENTIAL, TABULAR) else ():
            yield key, f"left out with the {self.law} law, which has a stiffness of its own"
        if "ductility" in given and "stiffness" in given:
            yield "ductility", "left out with interface.stiffness, which says the same"
        least = self.strength**2 / self.toughness / 2
        if self.stiffness is not None and not self.stiffness > least:
            why = "strength^2 / (2 toughness), with which the traction would drop at once"
            yield "stiffness", f"> {least:.10g}, {why}"

    def _rules_of_sliding(self, given: Mapping[str, object]) -> Iterator[tuple[str, str]]:
        if "shear_strength" in given and self.law not in (PLAIN, *mixed()):
            yield (
                "shear_strength",
                f"left out with the {self.law} law, which opens only: {one_of(mixed())} slide as well",
            )
        for (_, before), (opening, traction) in pairwise(self.table if self.slides else ()):
            if traction > before:
                yield (
                    "table",
                    f"without a rise of the traction, from {before:g} at the opening {opening:g}, as the bond slides",
                )
        if "shear_strength" in given and "shear_toughness" not in given:
            yield "shear_toughness", "a number > 0 with interface.shear_strength"
        if "shear_toughness" in given and "shear_strength" not in given:
            yield "shear_toughness", "left out without interface.shear_strength"
        for key in (key for key in ASK_FOR_SHEAR if key in given):
            if not self.slides:
                yield key, "left out without interface.shear_strength and interface.shear_toughness"
            elif self.law == EXPONENTIAL and key not in ("friction", "viscosity") and given[key] != "damage":
                yield key, f"left out with the {EXPONENTIAL} law, whose formula says it"
        if self.criterion == "power" and given.get("onset") == "turon":
            yield "onset", '"quadratic" with interface.criterion = "power"'

    @model_serializer(mode="wrap")
    def _as_given(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """The table without keys that were left out; the ductility is kept unless another key determines it."""
        absent = {key for key in LEFT_OUT if key not in self.model_fields_set or getattr(self, key) is None}
        if self.stiffness is not None or self.law in (EXPONENTIAL, TABULAR):
            absent.add("ductility")
        return {key: value for key, value in write(self).items() if key not in absent}
