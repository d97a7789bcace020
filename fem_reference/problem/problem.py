"""What every problem states whatever its specimen: interface, kinematics, load programme, fineness of the mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class Debonding:
    """Common part of a problem in plain numbers, in any consistent set of units.

    Parameters
    ----------
    width, plane : of the specimen; "stress" or "strain".
    strength, toughness, ductility, penalty : p_max, G_Ic, g_u / g_max, and the stiffness against closing.
    law_name : one of `fem_reference.problem.law.LAWS`, looked up by who solves: a mesh is one of any law.
    contact : where false, the secant of the opening side continues into closing.
    irreversible : where false, damage follows the present gap and nothing is dissipated.
    opening : the displacement programme, for instance ``(3.0,)`` or ``(1.5, 0.0, 3.0)``; it starts at zero.
    load_at : where the load acts and the opening is measured: "face" (uniform dead traction, mean displacement), "node"
        (the corner of the loaded face away from the interface) or "hinge" (its middle, where a node must be).
    kinematics : "linear" or "finite".
    degree, elements : Lagrange degree 1 to 4, elements along the specimen.
    steps : equal opening increments over the whole programme, ends of its branches added.
    snapshot_openings : fields are kept at the first converged step that reaches each of these openings.
    """

    strength: float
    toughness: float
    ductility: float
    law_name: str = "bilinear"
    width: float = 1.0
    plane: str = "stress"
    penalty: float = 1e5
    contact: bool = True
    irreversible: bool = True
    opening: tuple[float, ...] = (3.0,)
    load_at: str = "face"
    kinematics: str = "finite"
    degree: int = 2
    elements: int = 112
    steps: int = 150
    snapshot_openings: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        _one_of("plane", self.plane, ("stress", "strain"))
        _one_of("kinematics", self.kinematics, ("linear", "finite"))
        _one_of("load_at", self.load_at, ("face", "node", "hinge"))
        _one_of("degree", self.degree, (1, 2, 3, 4))
        self.require_positive("strength", "toughness", "penalty", "width", "steps")
        if not self.ductility > 1:
            raise ValueError(f"ductility: must be > 1, got {self.ductility}")
        if not np.any(self.opening):
            raise ValueError(f"opening: must have an opening other than 0, got {self.opening}")

    def require_place(self, layers: int) -> None:
        """Raise ValueError where the load is in the middle of a face of so many elements, and no node is."""
        if self.load_at == "hinge" and self.degree * layers % 2:
            raise ValueError(
                f"degree: must be even for a load in the middle of a face of {layers} element{'s' * (layers > 1)}, "
                f"got {self.degree}"
            )

    @property
    def presses(self) -> bool:
        """Whether faces beyond the bond meet: the programme goes below zero; to zero all gaps go together."""
        return self.contact and min(self.opening) < 0.0

    @property
    def unloads(self) -> bool:
        """Whether the programme goes down anywhere."""
        return any(after < before for before, after in zip((0.0, *self.opening), self.opening, strict=False))

    def require_positive(self, *names: str) -> None:
        """Raise ValueError where one of these is not."""
        for name in names:
            if not getattr(self, name) > 0:
                raise ValueError(f"{name}: must be > 0, got {getattr(self, name)}")


def _one_of(name: str, value: object, allowed: tuple) -> None:
    if value not in allowed:
        raise ValueError(f"{name}: must be one of {', '.join(map(str, allowed))}, got {value}")
