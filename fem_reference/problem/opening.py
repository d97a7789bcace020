"""A problem whose bond opens alone, in the numbers of its traction law."""

from __future__ import annotations

from dataclasses import dataclass, fields

from fem_reference.problem.law import MODELLED_LAWS, Law
from fem_reference.problem.problem import Debonding


@dataclass(frozen=True, kw_only=True)
class OpeningProblem(Debonding):
    """Parameters besides those of `Debonding`:

    strength, toughness, ductility, penalty : p_max [stress], G_Ic [energy per area], 2 G_Ic / (p_max g_max) (g_u /
        g_max of the bilinear law), and the stiffness against closing [stress per length].
    law_name : key of `fem_reference.problem.law.MODELLED_LAWS`.
    plateau, table : parameters of the trapezoidal and of the tabular law.
    contact : if False, the secant of the opening side continues into closing.
    irreversible : if False, damage follows the present gap and nothing is dissipated.
    """

    strength: float
    toughness: float
    ductility: float
    law_name: str = "bilinear"
    plateau: float = 0.5
    table: tuple[tuple[float, float], ...] = ()
    penalty: float = 1e5
    contact: bool = True
    irreversible: bool = True

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require_positive("strength", "toughness", "penalty")
        if not self.ductility > 1:
            raise ValueError(f"ductility: must be > 1, got {self.ductility}")
        if self.law_name not in MODELLED_LAWS:
            raise ValueError(f"law_name: must be one of {', '.join(MODELLED_LAWS)}, got {self.law_name}")

    @property
    def law(self) -> Law:
        shape = MODELLED_LAWS[self.law_name]
        own = {field.name: getattr(self, field.name) for field in fields(shape) if field.name in ("plateau", "table")}
        return shape(
            self.strength, self.toughness, self.ductility, self.penalty, self.contact, self.irreversible, **own
        )
