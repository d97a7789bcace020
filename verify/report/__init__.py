"""The report of a verification: one self-contained HTML file about all scenes. Imports no drawing library."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from verify.studies.cost.study import Study
    from verify.studies.found import Included
    from verify.verdict import SceneReport


@dataclass(frozen=True)
class Findings:
    """Runs, checks and studies of one verification.

    Parameters
    ----------
    reports : one for each scene, in the order of the page
    environment : versions and machine, name to value
    included : studies of other commands
    prices : what accuracy costs, by quick searches
    """

    reports: tuple[SceneReport, ...]
    environment: Mapping[str, str]
    included: Sequence[Included] = ()
    prices: Sequence[Study] = ()


def write(findings: Findings, path: Path, text: bool = False) -> None:
    """``verify.report.page.write``, imported on the first call, as it needs matplotlib and Jinja."""
    from verify.report import page

    page.write(findings, path, text)
