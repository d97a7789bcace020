"""Figures as they were drawn, before they become text of a page."""

from __future__ import annotations

from types import ModuleType

import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure


class Drawn(list[tuple[str, Figure]]):
    """Title and figure of all drawings of some modules, in the order in which they were made."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *modules: ModuleType) -> None:
        super().__init__()
        for module in modules:
            monkeypatch.setattr(module, "to_svg", self._keep)

    def _keep(self, figure: Figure, key: str, title: str, *more: float, **options: float) -> str:
        self.append((title, figure))
        return f"<svg>{key}</svg>"

    def axes(self, words: str, number: int = 0) -> Axes:
        """The axes of the only figure whose title has these words."""
        (figure,) = [figure for title, figure in self if words in title]
        return figure.axes[number]
