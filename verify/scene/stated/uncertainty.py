"""Uncertainties of the numbers of a scene, and of data with which it is compared."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import ConfigDict, SerializerFunctionWrapHandler, model_serializer, model_validator

from verify.scene.tables import Section, refuse

#: Tables of a scene whose numbers may have an uncertainty.
UNCERTAIN_TABLES = ("specimen", "material", "strip", "substrate", "interface")

#: Keys of measured data, or of a curve of another code, with what they are.
DATA_KEYS: Mapping[str, str] = {
    "data.load": "Of the loads of the data as a whole: load cell, width, scatter from specimen to specimen.",
    "data.opening": "Of the openings of the data as a whole: gauge, compliance of the machine.",
}

#: Largest relative standard uncertainty: beyond it a linear propagation means nothing.
MOST_UNCERTAIN = 0.3

#: What a table must be, in the words of a refusal.
UNCERTAIN_TABLE = "a table of keys of the scene and of data, like material.young = 0.02 and data.load = 0.005"


class Uncertainty(Section):
    """Relative standard uncertainties by the dotted key of the number that they belong to, independent of each other.

    The keys are dotted keys of the scene, as in ``material.young = 0.02``, with or without quotation marks, and those
    of `DATA_KEYS`.
    """

    model_config = ConfigDict(extra="allow")

    introduction: bool = True
    """Whether it is open where on the loaded face the load acts, which `debond validate` then counts as an input."""

    @model_validator(mode="before")
    @classmethod
    def _by_dotted_keys(cls, given: Any) -> Any:
        """Nested tables as dotted keys; values must be relative standard uncertainties."""
        if isinstance(given, Uncertainty):
            return given
        if not isinstance(given, Mapping):
            raise refuse(UNCERTAIN_TABLE, ((), given))
        pairs = list(_flat("", given))
        stated = dict(pairs)
        if len(stated) < len(pairs):
            twice = [((key,), value) for i, (key, value) in enumerate(pairs) if key in dict(pairs[:i])]
            raise refuse("stated once", twice[-1])
        rule = f"a relative standard uncertainty, a number > 0 and <= {MOST_UNCERTAIN:g}"
        wrong = [
            ((key,), one)
            for key, one in stated.items()
            if key != "introduction" and (type(one) not in (int, float) or not 0 < one <= MOST_UNCERTAIN)
        ]
        if wrong:
            raise refuse(rule, *wrong)
        return {key: value if key == "introduction" else float(value) for key, value in pairs}

    @model_serializer(mode="wrap")
    def _in_tables(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Dotted keys as nested tables, so that --set can replace a single key."""
        found: dict[str, Any] = {}
        for key, value in write(self).items():
            table, _, name = key.rpartition(".")
            (found.setdefault(table, {}) if table else found)[name] = value
        return found

    @property
    def inputs(self) -> Mapping[str, float]:
        """Uncertainties of numbers of the scene, by dotted key."""
        return {key: value for key, value in (self.model_extra or {}).items() if key not in DATA_KEYS}

    @property
    def data(self) -> Mapping[str, float]:
        """Uncertainties of the data, by dotted key; 0 where none is stated."""
        return {key: (self.model_extra or {}).get(key, 0.0) for key in DATA_KEYS}


def number_at(scene: Any, key: str) -> float | tuple[float, ...] | None:
    """The non-zero number of a dotted key of a scene, or several numbers (for instance of two arms) that share one
    relative error; None where there is none."""
    table, _, name = key.partition(".")
    inside = getattr(scene, table) if table in UNCERTAIN_TABLES else None
    value = inside.model_dump().get(name) if isinstance(inside, Section) else None
    numbers = value if isinstance(value, tuple) and value else (value,)
    return value if all(isinstance(one, float) and one != 0.0 for one in numbers) else None


def scaled(number: float | tuple[float, ...], factor: float) -> str:
    """A number, or several, times a factor, as TOML."""
    return str([one * factor for one in number]) if isinstance(number, tuple) else repr(number * factor)


def numbers_in(scene: Any) -> tuple[str, ...]:
    """Every dotted key that `number_at` knows: a list of two materials has none."""
    tables = {name: getattr(scene, name) for name in UNCERTAIN_TABLES}
    found = (f"{name}.{key}" for name, one in tables.items() if isinstance(one, Section) for key in one.model_dump())
    return tuple(key for key in found if number_at(scene, key) is not None)


def _flat(before: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Dotted keys and values; an empty nested table is kept as a value, so that it is refused."""
    if isinstance(value, Mapping) and (value or not before):
        for key, inner in value.items():
            yield from _flat(f"{before}.{key}" if before else str(key), inner)
    else:
        yield before, value
