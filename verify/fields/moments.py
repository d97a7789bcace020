"""More openings of the crack than a run keeps snapshots of, for the slider of the report: sampled more coarsely, and
made when the run is over, so that its time has nothing of them and its steps land on none of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from iga.mesh.bernstein import bernstein, tensor
from verify.fields.frames import bezier_values
from verify.result import Snapshot
from verify.scene.schema import Pose, Scene

#: Parts of the largest opening, between those that snapshots are kept at.
FRACTIONS = (0.05, 0.15, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9)

#: Sample intervals along each direction of an element.
INTERVALS = 2

#: The method whose bodies the report draws.
LEAD = "nurbs"


class Moments:
    """Called by a solver at every converged step, see `iga.run.OnFrame`; remembers those that first reach an opening.

    A specimen that is solved in another place than its own has none.
    """

    def __init__(self, scene: Scene) -> None:
        here = scene.pose == Pose()
        self._wanted = [part * max(0.0, *scene.load.opening) for part in FRACTIONS] if here else []
        self._makes: list[Callable[[], Mapping[str, Any] | None]] = []

    def __call__(self, opening: float, make: Callable[[], Mapping[str, Any] | None]) -> None:
        if self._wanted and opening >= self._wanted[0]:
            self._wanted = [wanted for wanted in self._wanted if wanted > opening]
            self._makes.append(make)

    def snapshots(self) -> tuple[Snapshot, ...]:
        return tuple(snapshot(made) for make in self._makes if (made := make()) is not None)


def snapshot(made: Mapping[str, Any]) -> Snapshot:
    """What is drawn of a frame as `iga.output.frames` tells it, in single precision."""
    parts = [_sampled(part) for part in made["cells"]]
    X, u, stress = (np.concatenate([part[i] for part in parts]).astype(np.float32) for i in range(3))
    names = ("s_q", "gap_q", "traction_q", "damage_q", "slip_q", "shear_q")
    bond = {name: made["bond"][name] for name in names if name in made["bond"]}
    return Snapshot(opening=made["opening"], load=made["load"], **bond, X_euvi=X, u_euvi=u, stress_euv=stress)


def _sampled(part: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Grids of X, u and sigma_xx; the stress is the polynomial through its values at the points of the part."""
    (p, q), w_eb = part["degrees"], part["w_eb"]
    t, s = np.meshgrid(*[np.linspace(0.0, 1.0, INTERVALS + 1)] * 2, indexing="ij")
    B_nb = tensor(bernstein(p, s.ravel()), bernstein(q, t.ravel()))
    stress_eb = bezier_values(part["stress_eqv"][..., :1], w_eb, part["degrees"], part["points_q"])
    values_ebf = np.concatenate([part["X_ebI"], part["u_ebi"], stress_eb], axis=-1)
    values_enf = np.einsum("nb,eb,ebf->enf", B_nb, w_eb, values_ebf) / (w_eb @ B_nb.T)[..., None]
    grid_euvf = values_enf.reshape(len(w_eb), INTERVALS + 1, INTERVALS + 1, -1)
    return grid_euvf[..., :2], grid_euvf[..., 2:4], grid_euvf[..., 4]
