"""Cases of all combinations of law, mode, points without cohesion, path, reversibility and kinematics.

Each combination is a small specimen that `iga` and DOLFINx solve on one mesh of biquadratic elements with the same
interface points: they discretise one problem alike, so that at the openings of the programme their loads agree as
closely as the solvers converge. At every point of the interface the tractions of both are those of the law as `verify`
has it, along the jumps of the run.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from iga.bases.lagrange import lagrange_rectangle
from verify.checks.mechanics.columns import law_of
from verify.methods.dolfinx import dolfinx_installed
from verify.methods.solve import prepare
from verify.result import steps_from_rows
from verify.scene.bond.mixed import mixed_bond
from verify.scene.load import load_scene
from verify.scene.schema import Scene
from verify.studies.frame import corners
from verify.studies.hard.case import Case, Finding, Trials
from verify.theory.law import KnownLaw
from verify.verdict import Check

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
    def is_case(self) -> bool:
        """Not where faces beyond the bond of arms that are not pressed cannot touch, and have no points; nor where
        sliding arms without contact cannot be pressed."""
        presses = self.path == "press"
        return presses or self.points == "bonded" if self.mode == "opens" else not presses or self.points == "unbonded"

    @property
    def scene(self) -> Scene:
        """Arms that are pulled apart, or bent on three rollers, with a lever (mixed-mode bending) where they unload."""
        name, keys = "dcb-as4peek", _OPENING[self.law]
        if self.mode == "slides":
            name = "mmb50-as4peek" if self.path in ("load", "unload") else "enf-as4peek"
            keys = f"{_MIXED[self.law]}, {_SHEAR}" + ", friction=0.3" * self.rubs
        contact = self.points == "unbonded" or self.mode == "opens" and self.path != "press"
        effects = f'contact={contact}, irreversible={self.irreversible}, kinematics="{self.kinematics}"'.lower()
        return load_scene(
            name,
            (
                *_ONE_MESH,
                f'interface={{law="{self.law}", penalty=1e4, {keys}}}',
                f"load.opening={PROGRAMMES[self.mode][self.path]}",
                f"effects={{{effects}}}",
            ),
        )


_FACTORS = (PROGRAMMES, _OPENING, ("bonded", "unbonded"), PROGRAMMES["opens"], (True, False), ("linear", "finite"))

#: All combinations that are cases.
TABLE = tuple(cell for factors in product(*_FACTORS) if (cell := Combination(*factors)).is_case)


#: Steps of a programme in both codes.
TABLE_STEPS = 24


@dataclass(frozen=True)
class Walk:
    """A run of one code: columns (n_steps,), and gap, traction, damage, slip, shear (n_steps, n_q) along the bond.

    ``s_q`` (n_q,) are the places of the points, ``bonded_q`` those with cohesion.
    """

    status: str
    steps: dict[str, np.ndarray]
    fields: dict[str, np.ndarray]
    s_q: np.ndarray
    bonded_q: np.ndarray

    def at(self, goals: Sequence[float]) -> np.ndarray:
        """Loads (n_goals,) where the programme reaches its openings; NaN where it does not."""
        found = self.steps["load"][corners(self.steps["opening"], goals)]
        return np.append(found, np.full(len(goals) - found.size, np.nan))


def _walked(solver: Callable[..., Any], problem: Any) -> Walk:
    bonds: list[dict[str, np.ndarray]] = []
    found = solver(problem, on_frame=lambda _, make: bonds.append(make()["bond"]))
    names: list[str] = [name for name in ("gap_q", "traction_q", "damage_q", "slip_q", "shear_q") if name in bonds[0]]
    stacked = {name: np.stack([bond[name] for bond in bonds]) for name in names}
    return Walk(found.status, steps_from_rows(found.rows), stacked, bonds[0]["s_q"], bonds[0]["bonded_q"])


def on_one_mesh(scene: Scene, steps: int) -> dict[str, Callable[[], Walk]]:
    """Runs of both codes on the mesh of DOLFINx, of elements of degree 2; of iga alone where there is no DOLFINx."""
    from iga.delamination.solution import solve

    model, (_, own) = prepare(scene, "dolfinx").problem, prepare(scene, "lagrange").problem
    specimen = model.specimen()
    meshes = tuple(lagrange_rectangle(specimen.X, body.Y, 2) for body in specimen.bodies)
    rule: dict[str, Any] = {"degree": 2, "interface_points": 3, "steps": steps}
    searched = scene.effects.kinematics == "finite"
    own = replace(own, **rule, meshes=meshes, interface_rule="gauss", search=searched)
    runs = {"iga": lambda: _walked(solve, own)}
    if not dolfinx_installed():
        return runs
    from fem_reference.solve import solve_debonding

    return runs | {"dolfinx": lambda: _walked(solve_debonding, replace(model, **rule))}


@dataclass(frozen=True)
class Agreement:
    """How closely the codes and the identities have to agree.

    ``loads``: over the largest. Rollers of both codes are springs of at least 1e3 times E1 times the width, which yield
    by less than a millionth of the opening. ``point``: tractions over the initial stiffness times the largest jump, and
    damage; a point whose gap is rounding may keep the wrong side of contact up to this part of the forces (``settle``
    of `iga.path.solver.Newton`). ``rounded``: energies, over the work. ``ledger``: external work less stored and
    dissipated energy, over the work, as in the check ``energy-ledger`` of a verification; the work of the load between
    the steps comes in addition. ``sums``: dissipated energy, over the work; codes sum it by the trapezoidal rule over
    16 parts of a step, which leaves a twelfth of (1/16)^2 of what a step takes.
    """

    loads: float = 1e-6
    point: float = 1e-8
    rounded: float = 1e-9
    ledger: float = 5e-3
    sums: float = 1.0 / 12.0 / 16.0**2 / TABLE_STEPS


MESH_ALIKE = Agreement()


def findings(cell: Combination) -> Iterator[Check]:
    """The checks of one combination: both codes against each other, and each against the identities."""
    scene, goals = cell.scene, cell.scene.load.opening
    steps = TABLE_STEPS * (2 if cell.rubs else 1)  # a fall under friction, between two steps, is work that nobody sees
    walks = {code: run() for code, run in on_one_mesh(scene, steps).items()}
    for code, walk in walks.items():
        name = f"{cell.name} {code}"
        yield Check("completed", name, float(walk.status != "complete"), 0.0, "exact", "The programme was completed.")
        yield from _point_by_point(cell, scene, name, walk)
        yield from _energies(cell, name, walk)
        yield from _path_independent(cell, name, walk.at(goals), goals)
    if "dolfinx" not in walks:
        return
    ours, theirs = (walks[code].at(goals) for code in ("iga", "dolfinx"))
    size, tolerance = float(np.nanmax(np.abs(theirs))), MESH_ALIKE.loads + _of_the_frame(cell, walks["dolfinx"])
    if cell.rubs:  # points stick and slip one after the other, so that the length of the steps counts to first order
        finer = on_one_mesh(scene, 2 * TABLE_STEPS)["iga"]().at(goals)
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
    of, held = walk.fields, walk.bonded_q
    none = np.zeros_like(of["gap_q"])
    g, s, p, t = (of.get(key, none) for key in ("gap_q", "slip_q", "traction_q", "shear_q"))
    reach, bond, law = float(np.abs([g, s]).max()), mixed_bond(scene), law_of(scene)
    if bond is not None:
        (K, Ks), paths = bond.slopes, [bond.path(*jump) for jump in zip(g[:, held].T, s[:, held].T, strict=True)]
        wanted = [np.stack([getattr(path, key) for path in paths], axis=1) for key in ("p", "t", "d")]
    else:
        assert isinstance(law, KnownLaw)
        K = Ks = float(law.stiffness)
        largest = np.maximum(g[:, held], 0.0)
        largest = np.maximum.accumulate(largest) if cell.irreversible else largest
        wanted = [law.traction(g[:, held], largest), none[:, held], law.damage(largest)]
    p_off, t_off, off = (
        float(np.abs(one[:, held] - by_law).max()) for one, by_law in zip((p, t, of["damage_q"]), wanted, strict=True)
    )
    far, meaning = max(p_off / K, t_off / Ks) / reach, "Tractions of bonded points are those of the law."
    yield Check("law", name, far, MESH_ALIKE.point, "exact", meaning)
    yield Check("damage", name, off, MESH_ALIKE.point, "exact", "Damage of bonded points is that of the law.")
    if not held.all():
        pulled = np.where(g > 0.0, p, 0.0)
        left = float(np.abs([pulled, t * (not cell.rubs)])[:, :, ~held].max()) / K / reach
        yield Check("unbonded", name, left, MESH_ALIKE.rounded, "exact", "What is not bonded only presses and rubs.")


def _energies(cell: Combination, name: str, walk: Walk) -> Iterator[Check]:
    """The ledger, and dissipated energy: it never comes back, and a reversible bond without friction has none."""
    work, lost = walk.steps["external_work"], walk.steps["dissipated_energy"]
    size = float(np.abs(work).max())
    gap = float(np.abs(work - walk.steps["stored_energy"] - lost).max()) / size
    allowed = MESH_ALIKE.ledger + _between_steps(walk) / size
    yield Check("ledger", name, gap, allowed, "exact", "External work is stored or dissipated.")
    back = max(0.0, -float(np.diff(lost).min())) / size
    yield Check("dissipation", name, back, MESH_ALIKE.sums, "exact", "Dissipated energy never comes back.")
    if not cell.irreversible and not cell.rubs:
        spent = float(np.abs(lost).max()) / size
        yield Check("reversible", name, spent, MESH_ALIKE.rounded, "exact", "A reversible bond dissipates nothing.")


def _between_steps(walk: Walk) -> float:
    """What the trapezoidal rule over the steps may miss of the work of the load: its change where every other step is
    left out, but none where the programme turns round."""
    d, P = walk.steps["opening"], walk.steps["load"]
    turns = np.flatnonzero(np.diff(np.sign(np.diff(d)))) + 1
    kept = np.union1d(np.arange(0, d.size, 2), [*turns, d.size - 1])
    return abs(float(np.trapezoid(P, d) - np.trapezoid(P[kept], d[kept]))) / 3.0


def _path_independent(cell: Combination, name: str, loads: np.ndarray, goals: Sequence[float]) -> Iterator[Check]:
    """Where the programme comes twice to an opening a reversible bond has the load of the first time, an irreversible
    one less after its damage has grown."""
    twice = loads[np.array(goals) == 1.0]
    if cell.rubs or twice.size != 2:
        return
    change = float(twice[1] / twice[0] - 1.0)
    if cell.irreversible:
        yield Check("softer", name, max(0.0, change), 0.0, "exact", "After damage the load is lower.")
    else:
        yield Check("returns", name, change, 1e-7, "exact", "A reversible bond has one load at an opening.")


def _case(mode: str, kinematics: str) -> Case:
    cells = [cell for cell in TABLE if (cell.mode, cell.kinematics) == (mode, kinematics)]

    def judge(_: Trials) -> Iterator[Finding]:
        for cell in cells:
            yield from findings(cell)

    hard = f"Every law, path and kind of point where the bond {mode}, {kinematics}, by two codes on one mesh."
    first = {cells[0].name: cells[0].scene}
    return Case(f"table-{mode}-{kinematics}", hard, lambda: first, judge, bases=("lagrange",))


COMBINATION_CASES = tuple(_case(mode, kinematics) for mode in PROGRAMMES for kinematics in ("linear", "finite"))
