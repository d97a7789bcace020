"""Values that `debond certify` has found for a problem, each with its uncertainty, kept in one file of the package."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal

from verify.scene.effects import simulated
from verify.scene.schema import Scene

CERTIFIED_FILE = Path(__file__).with_name("certified.json")

#: Tables of a scene that define its problem, together with the simulated effects; meshes, names and stated values do
#: not.
PROBLEM_TABLES = ("material", "strip", "substrate", "interface", "load")

#: Keys of a specimen that say how it is meshed.
MESH_KEYS = ("mesh", "groups")

#: Keys at values that say nothing of a plane problem, and came after values had been certified.
LATER_KEYS = {("lateral", "free"), ("E3", None), ("nu13", None), ("G13", None), ("G23", None)}

#: Kinds of quantities. The opening of ``work`` and ``zone`` is the last one of the programme.
CertifiedKind = Literal["peak", "peak_opening", "load_at", "work", "zone"]


@dataclass(frozen=True)
class Certified:
    """One value of a problem.

    quantity : name in words, like "load at 1.5"
    opening : opening of the quantity; None for a peak
    value : value in the units of the scene
    uncertainty : expanded uncertainty of ``value``, for 95 % [its unit]
    matched : change of ``value`` by keeping the initial pairs of points [its unit]; 0 where the scene itself keeps
        them, None where no run shows it
    """

    quantity: str
    kind: CertifiedKind
    opening: float | None
    value: float
    uncertainty: float
    matched: float | None = 0.0


def problem_key(scene: Scene) -> str:
    """Hash (20 hexadecimal digits) of everything that defines the problem: specimen, materials, interface, load,
    effects."""
    dumped = scene.model_dump(mode="json")
    problem: dict[str, Any] = {name: dumped[name] for name in PROBLEM_TABLES}
    problem["specimen"] = {key: value for key, value in dumped["specimen"].items() if key not in MESH_KEYS}
    for table in (problem["specimen"], *(problem[name] or {} for name in PROBLEM_TABLES[:3])):
        for key in LATER_KEYS & table.items():
            del table[key[0]]
    problem["effects"] = simulated(scene)
    return hashlib.sha256(json.dumps(problem, sort_keys=True).encode()).hexdigest()[:20]


def certified(scene: Scene) -> tuple[Certified, ...]:
    """The certified values of the problem of a scene; empty if it has not been certified."""
    entry = entries().get(problem_key(scene), {"values": []})
    return tuple(Certified(**one) for one in entry["values"])


@cache
def entries(path: Path = CERTIFIED_FILE) -> Mapping[str, Mapping[str, Any]]:
    """Key of a problem -> its ``scene``, ``units``, ``values`` as of `Certified`, and ``remarks``."""
    found: dict[str, Mapping[str, Any]] = json.loads(path.read_text())
    return found
