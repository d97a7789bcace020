"""Isogeometric solver for debonding interfaces; needs NumPy and SciPy only.

The public names are those of `__all__`; each is imported when it is first used, so that one module of the package does
not import the others.
"""

from __future__ import annotations

from importlib import import_module

TYPE_CHECKING = False  # type checkers treat this name as True; importing that of `typing` takes milliseconds
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from iga.bases.bspline import open_knots
    from iga.bases.lagrange import lagrange_rectangle
    from iga.bases.names import BASES
    from iga.bases.nurbs import nurbs_rectangle
    from iga.dcb import Problem as Dcb
    from iga.files.cad_body import body_mesh
    from iga.files.iga_reader import read_iga
    from iga.laws.laws import OPENING_LAWS as LAWS
    from iga.mesh.extraction import Mesh
    from iga.peel import Problem as Peel
    from iga.run import Solution
    from iga.specimen.layout import Moduli
    from iga.tsplines.lines import tensor_grid, with_line
    from iga.tsplines.tmesh import TMesh
    from iga.tsplines.tspline import tspline_rectangle

__all__ = [
    "BASES",
    "body_mesh",
    "Dcb",
    "lagrange_rectangle",
    "LAWS",
    "Mesh",
    "Moduli",
    "nurbs_rectangle",
    "open_knots",
    "Peel",
    "read_iga",
    "Solution",
    "solve",
    "tensor_grid",
    "TMesh",
    "tspline_rectangle",
    "with_line",
]

#: Name -> module, and its name there where that is another one.
_HOMES = {
    "BASES": "bases.names",
    "Dcb": "dcb:Problem",
    "LAWS": "laws.laws:OPENING_LAWS",
    "Mesh": "mesh.extraction",
    "Moduli": "specimen.layout",
    "Peel": "peel:Problem",
    "Solution": "run",
    "TMesh": "tsplines.tmesh",
    "body_mesh": "files.cad_body",
    "lagrange_rectangle": "bases.lagrange",
    "nurbs_rectangle": "bases.nurbs",
    "open_knots": "bases.bspline",
    "read_iga": "files.iga_reader",
    "tensor_grid": "tsplines.lines",
    "tspline_rectangle": "tsplines.tspline",
    "with_line": "tsplines.lines",
}


def solve(problem: Dcb | Peel, on_step: Callable[[Mapping[str, float]], None] | None = None) -> Solution:
    """Follow the load programme of a specimen.

    Parameters
    ----------
    problem : a `Dcb` or a `Peel`.
    on_step : called with the row of every converged step, as it comes (see `iga.output.rows`).

    Raises
    ------
    ValueError : a problem for which there is no mesh or no material.
    """
    from iga.delamination import solve

    return solve(problem, on_step)


if not TYPE_CHECKING:  # a type checker knows the names above and no others

    def __getattr__(name: str) -> object:
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        module, _, other = _HOMES[name].partition(":")
        return getattr(import_module(f"{__name__}.{module}"), other or name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
