"""The results of a verification, which its page shows. Imports no drawing library."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from verify.studies.found import Included
    from verify.studies.interface_rules import Study
    from verify.studies.paper.study import Study as Figures
    from verify.studies.plane.rates import Convergence
    from verify.studies.plane.study import PlaneStudy
    from verify.verdict import SceneReport


@dataclass(frozen=True)
class Findings:
    """Runs, checks and studies of one verification.

    Parameters
    ----------
    reports : one for each scene, in the order of the page
    environment : versions and machine, name to value
    quadrature : the study of the interface rules, where it was made
    paper : the runs behind Figures 6 to 8 of the paper, where they were made
    planes : the studies of plane problems, one a mesh file
    rates : the convergence of the bases in plane elasticity, where it was measured
    peels : the runs behind Figure 9 of the paper, where they were made
    included : studies of other commands
    """

    reports: tuple[SceneReport, ...]
    environment: Mapping[str, str]
    quadrature: Study | None = None
    paper: Figures | None = None
    planes: Sequence[PlaneStudy] = ()
    rates: tuple[Convergence, ...] = ()
    peels: Figures | None = None
    included: Sequence[Included] = ()
