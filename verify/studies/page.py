"""Pages of studies: one self-contained HTML file each, on the template ``studies/base.html.j2``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from matplotlib.axes import Axes

from verify.pages.style import plain
from verify.pages.template import rendered
from verify.pages.text import sentence
from verify.runs.environment import environment
from verify.studies.frame import Study


def write_study(
    study: Study, path: Path, filters: Mapping[str, Callable], template: str = "page.html.j2", **content: object
) -> None:
    """Write the page: the ``template``, which may be in the package of the study, with the study and ``content``."""
    about = {
        "study": study,
        "name": study.scene.name,
        "sentence": sentence(study.scene),
        "unresolved": study.unresolved,
        "environment": environment(),
    }
    page = rendered(f"verify.studies.{study.NAME}", template, filters, **about | content)
    path.write_text(page, encoding="utf-8")


def write_template(package: str, path: Path, **content: object) -> None:
    """Write the page of a package by its template, ``page.html.j2``."""
    path.write_text(rendered(package, "page.html.j2", {}, **content), encoding="utf-8")


def logarithmic(axes: Axes, x: str, y: str) -> None:
    """Logarithmic axes with plain numbers."""
    axes.set(xscale="log", yscale="log", xlabel=x, ylabel=y)
    for part in (axes.xaxis, axes.yaxis):
        plain(part)
