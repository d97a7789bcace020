"""Values that others have published for a scene, with tolerance and source."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from verify.scene.tables import MISSING, Broken, Section, as_pair


class Published(Section):
    """One number of another code, of an experiment or of a closed form.

    ``peak`` is the largest load, ``load_at`` the load at an ``opening``. Where several codes differ ``value`` is the
    range from the lowest to the highest. ``tolerance`` is relative to the nearest end of that range.
    """

    quantity: Literal["peak", "load_at"]
    """The largest load, or that at an opening."""
    opening: float | None = Field(default=None, gt=0)
    """Of load_at [length]."""
    leg: int | None = Field(default=None, ge=1)
    """Of load_at: the leg of the programme, counted from turn to turn; left out: where the opening is a new largest."""
    value: Annotated[tuple[float, float], BeforeValidator(as_pair)] = Field(
        description="a number, or a list of two, the lowest and the highest"
    )
    """Load [force]; of codes that differ the lowest and the highest, like [4.3, 4.5]."""
    tolerance: float = Field(gt=0, lt=1)
    """Relative, to the nearest end of that range."""
    kind: Literal["cross-code", "analytical"] = "cross-code"
    """What the value rests on."""
    source: str
    """Where it is written."""

    def _broken(self) -> Iterator[Broken]:
        if self.quantity == "load_at" and self.opening is None:
            yield ("opening",), "a number > 0", MISSING
        for key in ("opening", "leg"):
            if self.quantity == "peak" and getattr(self, key) is not None:
                yield (key,), "left out for a peak, wherever it is", getattr(self, key)
        for i, load in enumerate(self.value):
            if load <= 0:
                yield ("value", i), "> 0", load
        if 0 < self.value[1] < self.value[0]:
            yield ("value",), "the lowest before the highest", self.value
        if not self.source.strip():
            yield ("source",), "a text that says where the value is written", self.source

    def deviation(self, load: float) -> float:
        """Relative deviation of ``load`` from the nearest end of the range; 0 within the range."""
        low, high = self.value
        return load / low - 1 if load < low else load / high - 1 if load > high else 0.0 * load
