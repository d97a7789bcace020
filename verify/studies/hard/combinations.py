"""Cases of all combinations of law, mode, points without cohesion, path, reversibility and kinematics.

Each combination is a small specimen that `iga` and DOLFINx solve on one mesh of biquadratic elements with the same
interface points: they discretise one problem alike, so that at the openings of the programme their loads agree as
closely as the solvers converge. At every point of the interface the tractions of both are those of the law as `verify`
has it, along the jumps of the run.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from itertools import combinations as pairs
from itertools import product
from typing import Any

import numpy as np

from iga.bases.lagrange import lagrange_rectangle
from verify.checks.mechanics.columns import law_of
from verify.methods.solve import prepare, require
from verify.scene.bond.mixed import mixed_bond
from verify.scene.effects import simulated
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.studies.hard.case import Case, Finding, Trials, Variant
from verify.support.refusal import NotRun
from verify.verdict import Check

#: Mode -> laws; whether the bond opens or slides as well is in the specimen.
LAWS = {
    "opens": ("bilinear", "trapezoidal", "tabular", "exponential"),
    "slides": ("bilinear", "trapezoidal", "exponential"),
}

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
    "tabular": "table=[[0.01, 5.0], [0.04, 3.5], [0.15, 0.0]]",
    "exponential": "strength=5.0, toughness=0.3",
}
_SLIDING = "strength=5.0, toughness=0.3, shear_strength=8.0, shear_toughness=0.6"
_STIFF = 'stiffness=2e3, shear_stiffness=2e3, criterion="bk", exponent=2.284, onset="turon"'
_FRICTION = 0.3
_MESH = ("published=[]", "dolfinx.elements=24", "dolfinx.layers=1", "discretization.dofs=500", "discretization.steps=24")


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
        extra = f', friction={_FRICTION}' if self.rubs else ""
        keys = _OPENING[self.law] if self.mode == "opens" else _SLIDING + (_STIFF_OF[self.law]) + extra
        return load_scene(
            "dcb-as4peek" if self.mode == "opens" else slid,
            (
                *_MESH,
                f'interface={{law="{self.law}", penalty=1e4, {keys}}}',
                f"load.opening={PROGRAMMES[self.mode][self.path]}",
                f"effects.contact={str(free or self.points == 'unbonded').lower()}",
                f"effects.irreversible={str(self.irreversible).lower()}",
                f"effects.kinematics={self.kinematics}",
            ),
        )


_STIFF_OF = {"bilinear": f", {_STIFF}", "trapezoidal": f", {_STIFF}, plateau=0.4", "exponential": ""}


def left_out(cell: Combination) -> str:
    """Why a combination is no case of its own; empty for a case."""
    if cell.law not in LAWS[cell.mode]:
        return "the law is not defined for sliding"
    if cell.mode == "opens" and cell.points == "unbonded" and cell.path != "press":
        return "faces beyond the bond of arms that are not pressed cannot touch, and have no points"
    if cell.mode == "slides" and cell.points == "bonded" and cell.path == "press":
        return "without contact nothing presses"
    return ""


def _product() -> Iterator[Combination]:
    laws = tuple(dict.fromkeys(law for known in LAWS.values() for law in known))
    factors = ("opens", "slides"), laws, ("bonded", "unbonded"), tuple(PROGRAMMES["opens"]), (True, False)
    yield from (Combination(*cell) for cell in product(*factors, ("linear", "finite")))


#: All combinations that are cases.
TABLE = tuple(cell for cell in _product() if not left_out(cell))


def covering(table: Sequence[Combination]) -> tuple[Combination, ...]:
    """A few cells with every pair of values of two factors that the table has, chosen greedily in the table's order."""
    names = [field.name for field in fields(Combination)]

    def of(cell: Combination) -> set[tuple[Any, ...]]:
        return {(a, getattr(cell, a), b, getattr(cell, b)) for a, b in pairs(names, 2)}

    wanted, found = set().union(*map(of, table)), list[Combination]()
    while wanted:
        best = max(table, key=lambda cell: len(of(cell) & wanted))
        wanted -= of(best)
        found.append(best)
    return tuple(found)


@dataclass(frozen=True)
class Walk:
    """A run of one code: rows of all steps, and gap, traction, damage, slip, shear (n_steps, n_q) along the bond.

    ``s_q`` (n_q,) are the places of the points, ``bonded_q`` those with cohesion.
    """

    status: str
    rows: tuple[Any, ...]
    fields: dict[str, np.ndarray]
    s_q: np.ndarray
    bonded_q: np.ndarray

    def column(self, name: str) -> np.ndarray:
        """A column (n_steps,) of the rows."""
        return np.array([row[name] for row in self.rows])

    def at(self, goals: Sequence[float]) -> np.ndarray:
        """Loads (n_goals,) where the programme reaches its openings; NaN where it does not."""
        opening, load, found, after = self.column("opening"), self.column("load"), [], 0
        for goal in goals:
            there = np.flatnonzero(np.abs(opening[after:] - goal) <= 1e-9 * max(map(abs, goals)))
            after = after + int(there[0]) if there.size else opening.size
            found.append(load[after] if there.size else np.nan)
        return np.array(found)


def _walked(solver: Callable[..., Any], problem: Any) -> Walk:
    bonds: list[dict[str, np.ndarray]] = []
    found = solver(problem, on_frame=lambda _, make: bonds.append(make()["bond"]))
    names = [name for name in ("gap_q", "traction_q", "damage_q", "slip_q", "shear_q") if name in bonds[0]]
    stacked = {name: np.stack([bond[name] for bond in bonds]) for name in names}
    return Walk(found.status, tuple(found.rows), stacked, bonds[0]["s_q"], bonds[0]["bonded_q"])


def on_one_mesh(scene: Scene, steps: int) -> dict[str, Callable[[], Walk]]:
    """Runs of both codes on the mesh of DOLFINx, of elements of degree 2."""
    from fem_reference.solve import solve_debonding
    from iga.delamination.solution import solve

    model, (_, own) = prepare(scene, "dolfinx").problem, prepare(scene, "lagrange").problem
    specimen = model.specimen()
    meshes = tuple(lagrange_rectangle(specimen.X, body.Y, 2) for body in specimen.bodies)
    rule: dict[str, Any] = {"degree": 2, "interface_points": 3, "steps": steps}
    searched = scene.effects.kinematics == "finite"
    own = replace(own, **rule, meshes=meshes, interface_rule="gauss", search=searched)
    return {"iga": lambda: _walked(solve, own), "dolfinx": lambda: _walked(solve_debonding, replace(model, **rule))}


@dataclass(frozen=True)
class Agreement:
    """How closely the codes and the identities have to agree.

    ``loads``: over the largest. Rollers of both codes are springs of at least 1e3 times E1 times the width, which yield
    by less than a millionth of the opening. ``point``: tractions over the initial stiffness times the largest jump, and
    damage; a point whose gap is rounding may keep the wrong side of contact up to this part of the forces (``settle`` of
    `iga.path.solver.Newton`). ``rounded``: energies, over the work. ``ledger``: external work less stored and dissipated
    energy, over the work: the sums over steps are off by a thousandth (``ledger`` of `iga.path.energy.Balance`) in the
    work of the load and in that of the bond.
    """

    loads: float = 1e-6
    point: float = 1e-8
    rounded: float = 1e-9
    ledger: float = 2e-3


AGREE = Agreement()


def findings(cell: Combination) -> Iterator[Check]:
    """The checks of one combination: both codes against each other, and each against the identities."""
    scene, goals = cell.scene, cell.scene.load.opening
    walks = {code: run() for code, run in on_one_mesh(scene, 24).items()}
    for code, walk in walks.items():
        name = f"{cell.name} {code}"
        yield Check("completed", name, float(walk.status != "complete"), 0.0, "exact", "The programme was completed.")
        yield from _point_by_point(cell, scene, name, walk)
        yield from _energies(cell, name, walk)
        yield from _path_independent(cell, name, walk.at(goals), goals)
    ours, theirs = (walks[code].at(goals) for code in ("iga", "dolfinx"))
    size, tolerance = float(np.nanmax(np.abs(theirs))), AGREE.loads + _of_the_frame(cell, walks["dolfinx"])
    if cell.rubs:  # points stick and slip one after the other, so that the length of the steps counts to first order
        finer = on_one_mesh(scene, 48)["iga"]().at(goals)
        tolerance += 4.0 * float(np.max(np.abs(finer - ours))) / size
    away, meaning = float(np.max(np.abs(ours - theirs))) / size, "Both codes have the same loads on the same mesh."
    yield Check("same-loads", cell.name, away, tolerance, "cross-code", meaning)


def _of_the_frame(cell: Combination, walk: Walk) -> float:
    """What the two definitions of the jump differ by, relative to it: 0 with linear kinematics.

    iga has gap and slip along the lower face, DOLFINx along the undeformed or the mean face. Where faces meet at an
    angle a, the gap differs by the part a^2, and the slip by a times the gap.
    """
    if cell.kinematics == "linear":
        return 0.0
    carries = walk.bonded_q & (walk.fields["damage_q"] < 1.0)
    angle = float(np.abs(np.gradient(walk.fields["gap_q"], walk.s_q, axis=1))[carries].max())
    return angle if cell.mode == "slides" else angle**2


def _point_by_point(cell: Combination, scene: Scene, name: str, walk: Walk) -> Iterator[Check]:
    """Tractions and damage from the definition of the law, along the jumps that the run went through."""
    of, free_q = walk.fields, ~walk.bonded_q
    g_tq, p_tq, held = of["gap_q"], of["traction_q"], walk.bonded_q
    if cell.mode == "opens":
        law = law_of(scene)
        k_tq = np.maximum.accumulate(np.maximum(g_tq, 0.0)) if cell.irreversible else np.maximum(g_tq, 0.0)
        jumps = ((p_tq, law.traction(g_tq, k_tq), float(law.stiffness)),)  # type: ignore[attr-defined]
        d_tq = law.damage(k_tq)  # type: ignore[attr-defined]
        if not cell.irreversible:
            jumps = ((p_tq, np.where(g_tq < 0.0, jumps[0][1], law.traction(g_tq)), jumps[0][2]),)
    else:
        bond = mixed_bond(scene)
        assert bond is not None
        s_tq = of["slip_q"]
        paths = [bond.path(g_tq[:, q], s_tq[:, q]) for q in np.flatnonzero(held)]
        p, t, d = (np.stack([getattr(path, key) for path in paths], axis=1) for key in ("p", "t", "d"))
        known = [_spread(values, held) for values in (p, t, d)]
        jumps, d_tq = ((p_tq, known[0], bond.slopes[0]), (of["shear_q"], known[1], bond.slopes[1])), known[2]
    far = max(float(np.abs(found - wanted)[:, held].max()) / size for found, wanted, size in jumps)
    reach = float(np.abs(g_tq).max()) if cell.mode == "opens" else float(max(np.abs(g_tq).max(), np.abs(s_tq).max()))
    yield Check("law", name, far / reach, AGREE.point, "exact", "Tractions of bonded points are those of the law.")
    off = float(np.abs(of["damage_q"] - d_tq)[:, held].max())
    yield Check("damage", name, off, AGREE.point, "exact", "Damage of bonded points is that of the law.")
    if free_q.any():
        pulled = np.abs(np.where(g_tq > 0.0, p_tq, 0.0))[:, free_q].max()
        shears = 0.0 if cell.mode == "opens" or cell.rubs else np.abs(of["shear_q"])[:, free_q].max()
        left = float(max(pulled, shears)) / jumps[0][2] / reach
        yield Check("unbonded", name, left, AGREE.rounded, "exact", "What is not bonded carries pressure and friction alone.")


def _spread(values: np.ndarray, held: np.ndarray) -> np.ndarray:
    """Values (n_steps, n_held) of the bonded points at all points, zero elsewhere."""
    whole = np.zeros((len(values), held.size))
    whole[:, held] = values
    return whole


def _energies(cell: Combination, name: str, walk: Walk) -> Iterator[Check]:
    """The ledger, and dissipated energy: it never comes back, and a reversible bond without friction has none."""
    work, lost = walk.column("external_work"), walk.column("dissipated_energy")
    size = float(np.abs(work).max())
    gap = float(np.abs(work - walk.column("stored_energy") - lost).max()) / size
    yield Check("ledger", name, gap, AGREE.ledger, "exact", "External work is stored or dissipated.")
    back = max(0.0, -float(np.diff(lost).min())) / size
    yield Check("dissipation", name, back, AGREE.rounded, "exact", "Dissipated energy never comes back.")
    if not cell.irreversible and not cell.rubs:
        spent = float(np.abs(lost).max()) / size
        yield Check("reversible", name, spent, AGREE.rounded, "exact", "A reversible bond dissipates nothing.")


def _path_independent(
    cell: Combination, name: str, loads: np.ndarray, goals: Sequence[float]
) -> Iterator[Check]:
    """Where the programme comes twice to an opening a reversible bond has the load of the first time, an irreversible
    one less after its damage has grown."""
    if cell.rubs or cell.path == "load":
        return
    first, second = (i for i, goal in enumerate(goals) if goal == 1.0) if goals.count(1.0) == 2 else (None, None)
    if first is None or second is None:
        return
    change = float(loads[second] / loads[first] - 1.0)
    if cell.irreversible:
        yield Check("softer", name, max(0.0, change), 0.0, "exact", "After damage the load is lower.")
    else:
        yield Check("returns", name, change, 1e-7, "exact", "A reversible bond has one load at an opening.")
