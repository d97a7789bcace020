"""Cases of all combinations of law, mode, points without cohesion, path, reversibility and kinematics.

Each combination is a small specimen that `iga` and DOLFINx solve on one mesh of biquadratic elements with the same
interface points: they discretise one problem alike, so that at the openings of the programme their loads agree as
closely as the solvers converge. At every point of the interface the tractions of both are those of the law as `verify`
has it, along the jumps of the run.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

from verify.scene.load import load_scene
from verify.scene.schema import Scene

#: Mode -> path -> programme. A sliding bond is pressed by its rollers, where it rubs.
PROGRAMMES = {
    "opens": {
        "load": "[1.0, 2.0, 3.0]",
        "unload": "[1.0, 2.5, 1.0, 3.0]",
        "reverse": "[2.5, 0.0, 1.0, 3.0]",
        "press": "[2.5, -0.003, 1.0, 3.0]",
    },
    "slides": {
        "load": "[1.0, 2.0, 4.5]",
        "unload": "[1.0, 3.0, 1.0, 4.5]",
        "reverse": "[1.0, 3.0, -1.5, 1.0, 4.5]",
        "press": "[1.0, 3.0, 1.0, 4.5]",
    },
}

#: Tractions this low spread the process zone over several elements: no point breaks alone, and the load has no falls.
_OPENING = {
    "bilinear": "strength=5.0, toughness=0.3, ductility=10.0",
    "trapezoidal": "strength=3.0, toughness=0.3, ductility=10.0, plateau=0.4",
    "trilinear": "strength=5.0, toughness=0.3, ductility=10.0, knee=0.3, knee_traction=0.4",
    "tabular": "table=[[0.01, 5.0], [0.04, 3.5], [0.15, 0.0]]",
    "exponential-softening": "strength=5.0, toughness=0.3, ductility=10.0, decay=3.0",
    "exponential": "strength=5.0, toughness=0.3",
}
_SHEAR = "shear_strength=8.0, shear_toughness=0.6"
_NORMAL, _BK = "strength=5.0, toughness=0.3", 'stiffness=2e3, criterion="bk", exponent=2.284, onset="turon"'
_POWER = 'stiffness=2e3, criterion="power", exponent=1.5'
_MIXED = {
    "bilinear": f"{_NORMAL}, {_BK}, shear_stiffness=2e3",
    "trapezoidal": f"{_NORMAL}, {_BK}, shear_stiffness=2e3, plateau=0.4",
    "trilinear": f"{_NORMAL}, {_POWER}, shear_stiffness=3e3, knee=0.3, knee_traction=0.4",
    "tabular": "table=[[0.0025, 5.0], [0.04, 3.5], [0.14, 0.0]], shear_stiffness=3e3",
    "exponential-softening": f"{_NORMAL}, {_POWER}, shear_stiffness=2e3, decay=3.0",
    "exponential": _NORMAL,
}
_FRICTION = 0.3
_ONE_MESH = ("published=[]", "dolfinx.elements=24", "dolfinx.layers=1", "discretization.dofs=1000")


@dataclass(frozen=True)
class Combination:
    """One cell of the table. ``points``: "unbonded" where points without cohesion can touch, "bonded" without them."""

    mode: str
    law: str
    points: str
    path: str
    irreversible: bool
    kinematics: str

    @property
    def name(self) -> str:
        kind = "irreversible" if self.irreversible else "reversible"
        return "-".join((self.mode, self.law, self.points, self.path, kind, self.kinematics))

    @property
    def rubs(self) -> bool:
        return self.mode == "slides" and self.path == "press"

    @property
    def scene(self) -> Scene:
        """Arms that are pulled apart, or bent on three rollers, with a lever (mixed-mode bending) where they unload."""
        free = self.mode == "opens" and self.path != "press"
        slid = "mmb50-as4peek" if self.path in ("load", "unload") else "enf-as4peek"
        extra = f", friction={_FRICTION}" if self.rubs else ""
        keys = _OPENING[self.law] if self.mode == "opens" else f"{_MIXED[self.law]}, {_SHEAR}{extra}"
        return load_scene(
            "dcb-as4peek" if self.mode == "opens" else slid,
            (
                *_ONE_MESH,
                f'interface={{law="{self.law}", penalty=1e4, {keys}}}',
                f"load.opening={PROGRAMMES[self.mode][self.path]}",
                f"effects.contact={str(free or self.points == 'unbonded').lower()}",
                f"effects.irreversible={str(self.irreversible).lower()}",
                f"effects.kinematics={self.kinematics}",
            ),
        )


def left_out(cell: Combination) -> str:
    """Why a combination is no case of its own; empty for a case."""
    if cell.mode == "opens" and cell.points == "unbonded" and cell.path != "press":
        return "faces beyond the bond of arms that are not pressed cannot touch, and have no points"
    if cell.mode == "slides" and cell.points == "bonded" and cell.path == "press":
        return "without contact nothing presses"
    return ""


_FACTORS = (PROGRAMMES, _OPENING, ("bonded", "unbonded"), PROGRAMMES["opens"], (True, False), ("linear", "finite"))

#: All combinations that are cases.
TABLE = tuple(cell for factors in product(*_FACTORS) if not left_out(cell := Combination(*factors)))
