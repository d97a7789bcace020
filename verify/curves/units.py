"""Units of lengths and forces: in the header of a column, and of a scene."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

#: Unit -> its size in m, or in N. Capitals count only where two units differ by nothing else.
LENGTH_UNITS = {
    **{"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "micron": 1e-6},
    **{"in": 0.0254, "inch": 0.0254, "inches": 0.0254, "mil": 2.54e-5, "ft": 0.3048},
}
FORCE_UNITS = {
    **{"N": 1.0, "kN": 1e3, "MN": 1e6, "mN": 1e-3, "daN": 10.0, "gf": 9.80665e-3, "kgf": 9.80665, "kp": 9.80665},
    **{"lbf": 4.4482216152605, "lb": 4.4482216152605, "lbs": 4.4482216152605, "kip": 4448.2216152605},
}


@dataclass(frozen=True)
class Unit:
    """A unit as it is written, and its size in m, or in N."""

    name: str
    size: float
    is_length: bool


@dataclass(frozen=True)
class Units:
    """The units of a scene; None where its label does not name them."""

    length: Unit | None = None
    force: Unit | None = None

    def own(self, unit: Unit) -> Unit | None:
        """The unit of the scene for what is in another one."""
        return self.length if unit.is_length else self.force


def unit(text: str) -> Unit | None:
    """The unit of a word like kN or mm; None of any other word."""
    word = text.strip()
    for table, is_length in ((LENGTH_UNITS, True), (FORCE_UNITS, False)):
        exact = [name for name in table if name == word]
        if len(word) > 1:  # a single letter is a unit as it stands alone
            exact = exact or [name for name in table if name.lower() == word.lower()]
        if exact and len({table[name] for name in exact}) == 1:
            return Unit(exact[0], table[exact[0]], is_length)
    return None


def unit_of_column(name: str) -> Unit | None:
    """The unit in brackets behind the name of a column, or behind its last blank, comma or underscore."""
    bracketed = re.search(r"[(\[]\s*([^()\[\]]+?)\s*[)\]]\s*$", name)
    if bracketed:
        return unit(bracketed[1])
    words = re.split(r"[\s_,/]+", name.strip(' ,;"'))
    return unit(words[-1]) if len(words) > 1 else None


def units_of(label: str) -> Units:
    """The units that a label like "N, mm, MPa" names."""
    named: Sequence[Unit] = [found for word in re.split(r"[,;\s]+", label) if (found := unit(word)) is not None]
    length = next((one for one in named if one.is_length), None)
    return Units(length, next((one for one in named if not one.is_length), None))
