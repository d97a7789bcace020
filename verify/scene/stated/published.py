"""Values that others have published for a scene, with tolerance and source."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError

from verify.scene.tables import Section, refuse


def _as_range(value: object) -> object:
    """One number is a range of no width."""
    if not isinstance(value, list | tuple):
        return (value, value)
    if len(value) != 2:
        raise refuse("a number, or a list of two, the lowest and the highest", ((), list(value)))
    return tuple(value)


class Published(Section):
    """One number of another code, of an experiment or of a closed form.

    ``peak`` is the largest load, ``load_at`` the load at an ``opening``. Where several codes differ ``value`` is the
    range from the lowest to the highest. ``tolerance`` is relative to the nearest end of that range.
    """

    quantity: Literal["peak", "load_at"]
    """The largest load, or that at an opening."""
    opening: float | None = Field(default=None, gt=0, validate_default=True)
    """Of load_at [length]."""
    leg: int | None = Field(default=None, ge=1, validate_default=True)
    """Of load_at: the leg of the programme, counted from turn to turn; left out: where the opening is a new largest."""
    value: Annotated[tuple[float, float], BeforeValidator(_as_range)]
    """Load [force]; of codes that differ the lowest and the highest, like [4.3, 4.5]."""
    tolerance: float = Field(gt=0, lt=1)
    """Relative, to the nearest end of that range."""
    kind: Literal["cross-code", "analytical"] = "cross-code"
    """What the value rests on."""
    source: str
    """Where it is written."""

    @field_validator("opening")
    @classmethod
    def _where_it_is_asked_for(cls, opening: float | None, info: ValidationInfo) -> float | None:
        quantity = info.data.get("quantity")
        if quantity == "load_at" and opening is None:
            raise PydanticCustomError("missing", "missing")
        if quantity == "peak" and opening is not None:
            raise refuse("left out for a peak, wherever it is", ((), opening))
        return opening

    @field_validator("leg")
    @classmethod
    def _of_a_load(cls, leg: int | None, info: ValidationInfo) -> int | None:
        if leg is not None and info.data.get("quantity") == "peak":
            raise refuse("left out for a peak, wherever it is", ((), leg))
        return leg

    @field_validator("value")
    @classmethod
    def _lowest_first(cls, value: tuple[float, float]) -> tuple[float, float]:
        wrong = [((i,), load) for i, load in enumerate(value) if load <= 0]
        if wrong:
            raise refuse("> 0", *wrong)
        if value[0] > value[1]:
            raise refuse("the lowest before the highest", ((), list(value)))
        return value

    @field_validator("source")
    @classmethod
    def _can_be_looked_up(cls, source: str) -> str:
        if not source.strip():
            raise refuse("a text that says where the value is written", ((), source))
        return source

    def deviation(self, load: float) -> float:
        """Relative deviation of ``load`` from the nearest end of the range; 0 within the range."""
        low, high = self.value
        return load / low - 1 if load < low else load / high - 1 if load > high else 0.0 * load
