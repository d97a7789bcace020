"""Load-opening curves and traction laws in the regression tests of other projects. Needs NumPy only to be imported."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from verify.curves.compare import Points, checks, compare
from verify.curves.read import CurveError, Reading, columns_of, read_curve, sound
from verify.curves.wording import complaints, remarks, table

if TYPE_CHECKING:
    from verify.scene.schema import Scene
    from verify.theory.mixed_law import MixedBond

__all__ = ["CurveError", "CurveLike", "Reading", "assert_curves_close", "assert_law"]


class _Result(Protocol):
    @property
    def opening(self) -> ArrayLike: ...

    @property
    def load(self) -> ArrayLike: ...


class _Frame(Protocol):
    @property
    def columns(self) -> Any: ...

    def __getitem__(self, name: Any) -> Any: ...


_Table = Mapping[str, ArrayLike] | np.ndarray | _Frame
CurveLike = str | os.PathLike[str] | tuple[ArrayLike, ArrayLike] | _Table | _Result


def assert_curves_close(
    actual: CurveLike,
    expected: CurveLike,
    *,
    curve: float | None = None,
    peak: float | None = None,
    energy: float | None = None,
    end: float | None = None,
    programme: Sequence[float] | None = None,
    actual_as: Reading | None = None,
    expected_as: Reading | None = None,
    scene: Scene | str | os.PathLike[str] | None = None,
) -> None:
    """Fail unless one load-opening curve is as close to another as the given tolerances ask.

    Each tolerance is relative; at least one must be given. With P the load over the opening D that a test under
    displacement control would show (points whose opening exceeds all before, a vertical drop at a snap-back), P_e that
    of ``expected``, and D_i = i end / 400, i = 1 ... 400::

        curve     sqrt( sum_i (P(D_i) - P_e(D_i))^2 / sum_i P_e(D_i)^2 )    <= curve
        peak      | max P / max P_e - 1 |                                  <= peak
        energy    | W - W_e | / | W_e |,  W = integral of P dD on the path  <= energy

    ``actual`` must reach ``end`` as well: a run that stops early is not close. A curve whose first opening is above 0
    is joined to the origin by a straight line.

    ``curve`` asks for more than that: no point of ``actual`` may be farther from ``expected`` than 4 times as much, in
    parts of its own opening and load; those of a snap-back count where ``expected`` has one. Where ``expected``
    unloads, every leg from turn to turn must be there, with its loads, secant stiffness, residual opening and lost work
    within ``curve``.

    Parameters
    ----------
    actual, expected
        Opening (n,) and load (n,) along the path, in units of which only the scales of the readings know: a pair of
        sequences or array (2, n); columns of a mapping, a structured array or a data frame; an object with ``opening``
        and ``load``, as a result of this package is; or the path of a text file or of the folder of a run.
    curve, peak, energy : relative tolerances, 0.01 for 1 %
    end : compare up to this opening; default: the last of ``expected``
    programme : the openings at which the load turns, and the last one; default: those at which ``expected``
        unloads. A path that snaps back does not unload: it comes back at smaller loads.
    actual_as, expected_as
        Which columns are opening and load, and what they are multiplied by; default: those of these names, unscaled.
    scene : that both curves are of, its name or file: a failure then says which cause explains it best

    Raises
    ------
    AssertionError
        With a table of both curves, the opening at which they differ most, and every tolerance that is broken.
    ValueError, TypeError
        An invalid curve or tolerance (missing file or column, text or NaN among the numbers, one point, openings
        without overlap): the test could not be made, it did not fail.

    Examples
    --------
    >>> from verify.testing import Reading, assert_curves_close
    >>> expected = [0, 1, 2, 3], [0.0, 4.0, 3.0, 2.0]
    >>> history = {"U2": [0, -1, -2, -3], "RF2": [0, -4020, -3015, -2010]}
    >>> metres = Reading(opening="U2", load="RF2", opening_scale=-1, load_scale=-1e-3)
    >>> assert_curves_close(history, expected, actual_as=metres, curve=0.01, peak=0.01, energy=0.01)
    >>> assert_curves_close(history, expected, actual_as=metres, curve=0.002)
    Traceback (most recent call last):
        ...
    AssertionError: actual is not close to expected: curve error 0.5 %, more than 0.2 %
    ...
    """
    __tracebackhide__ = True
    limits = {"curve": curve, "peak": peak, "energy": energy}
    if all(limit is None for limit in limits.values()):
        raise TypeError("assert_curves_close needs a tolerance: curve, peak or energy")
    for name, limit in limits.items():
        _tolerance(name, limit)
    if end is not None and (isinstance(end, bool) or not isinstance(end, Real)):
        raise TypeError(f"end: must be a number, got {end!r}")
    if programme is not None and not _are_numbers(programme):
        raise TypeError(f"programme: must be openings, got {programme!r}")
    names = ("actual", "expected")
    curves = points("actual", actual, actual_as), points("expected", expected, expected_as)
    found = compare(*curves, end, names, programme=programme)
    judged = checks(found, **limits)
    if not all(check.passed for check in judged):
        broken = "; ".join([*complaints(found, judged), *remarks(found)])
        lines = [f"actual is not close to expected: {broken}", *table(found, (), judged)]
        lines += [] if scene is None else _why(*curves, scene, curve)
        raise AssertionError("\n".join(lines))


def _why(actual: Points, expected: Points, of: Scene | str | os.PathLike[str], curve: float | None) -> list[str]:
    """A line on what explains the deviation best, where anything does."""
    from verify.checks.between_codes import CODE_TOLERANCE
    from verify.diagnosis.classify import diagnose
    from verify.scene.load import load_scene
    from verify.scene.schema import Scene

    scene = of if isinstance(of, Scene) else load_scene(str(of))
    found = diagnose("actual", actual, expected, scene, curve or CODE_TOLERANCE)
    return [] if found is None else [found.sentence]


def assert_law(
    law: Any,
    of: Scene | MixedBond | str | os.PathLike[str],
    *,
    tractions: float = 1e-4,
    tangent: float = 1e-3,
    ignore: Sequence[str] = (),
) -> None:
    """Fail unless a traction law is that of a bond on all displacement paths of `debond law`.

    ``law(g, s, state, dt)`` is called step by step with an opening, a slip, the state that it returned at the step
    before (None at first) and the time of the step, of which a path takes 1 in all. It returns ``p, t, state``, or
    ``p, t, state, ((dp_dg, dp_ds), (dt_dg, dt_ds))``; a tangent is held against differences.

    Parameters
    ----------
    law : the function
    of : a scene, its name or file, or a `verify.theory.mixed_law.MixedBond`
    tractions : largest deviation of tractions, in parts of the strengths, and of energies, relative
    tangent : largest deviation of the tangent, in parts of the initial stiffness
    ignore : names of checks that may be broken

    Raises
    ------
    AssertionError
        With the defect that explains the deviation, where one does, and every broken check.
    ValueError, TypeError
        A tolerance, scene or law that makes no test: a law that raises or returns no numbers among them.

    Examples
    --------
    >>> from verify.testing import assert_law
    >>> from verify.theory.mixed_law import MixedBond
    >>> bond = MixedBond("bilinear", (80.0, 100.0), (0.969, 1.719), (1e5, 1e5), 1e5, exponent=2.284)
    >>> def law(g, s, state, dt):
    ...     return 1e5 * g, 1e5 * s, state
    >>> assert_law(law, bond)
    Traceback (most recent call last):
        ...
    AssertionError: the law is not that of the bond: unknown: ...
    ...
    """
    __tracebackhide__ = True
    from verify.checks.table import check_table
    from verify.studies.law.judge import Tolerances, judge
    from verify.studies.law.laws import followed
    from verify.studies.law.paths import paths
    from verify.theory.mixed_law import MixedBond

    for name, limit in (("tractions", tractions), ("tangent", tangent)):
        _tolerance(name, limit)
    if not callable(law):
        raise TypeError(f"law: must be a function of g, s, state and dt, got {type(law).__name__}")
    if isinstance(of, MixedBond):
        bond, ways = of, paths(of)
    else:
        bond, ways = _subject(of)
    given, far = followed(law, ways)
    found = judge(bond, ways, given, Tolerances(tractions, tangent), far)
    broken = [check for check in found.broken if check.name not in ignore]
    if broken:
        why = "; ".join(one.sentence for one in found.defects) or f"{len(broken)} checks are broken"
        raise AssertionError("\n".join([f"the law is not that of the bond: {why}", *check_table(broken)]))


def _subject(of: Any) -> tuple[Any, Any]:
    """The bond of a scene, or of its name or file, and its paths."""
    from verify.scene.load import load_scene
    from verify.scene.schema import Scene
    from verify.studies.law.study import subject

    if not isinstance(of, Scene | str | os.PathLike):
        raise TypeError(f"of: must be a scene, its name or file, or a MixedBond, got {type(of).__name__}")
    found = subject(of if isinstance(of, Scene) else load_scene(str(of)))
    return found.bond, found.ways


def _are_numbers(values: Any) -> bool:
    listed = isinstance(values, Sequence | np.ndarray) and not isinstance(values, str)
    return listed and all(isinstance(one, Real) and not isinstance(one, bool) for one in values)


def _tolerance(name: str, limit: float | None) -> None:
    if limit is None:
        return
    if isinstance(limit, bool) or not isinstance(limit, Real):
        raise TypeError(f"{name}: must be a number, got {limit!r}")
    if not 0 <= limit < np.inf:
        raise ValueError(f"{name}: must be >= 0 and finite, got {limit!r}")


def points(name: str, source: CurveLike, reading: Reading | None) -> Points:
    """Opening (n,) and load (n,) of a curve in any of its forms; ``name`` begins the sentence of a refusal."""
    if reading is not None and not isinstance(reading, Reading):
        raise TypeError(f"{name}_as: must be a Reading, got {type(reading).__name__}")
    reading = reading or Reading()
    if isinstance(source, str | os.PathLike):
        return read_curve(Path(source), reading)
    opening, load = _two_columns(name, source, reading)
    d, P = _numbers(f"{name}, opening", opening), _numbers(f"{name}, load", load)
    if d.size != P.size:
        raise CurveError(f"{name}: opening and load must be of one length, got {d.size} and {P.size}")
    return sound(name, d, P, reading)


def _two_columns(name: str, source: Any, reading: Reading) -> tuple[Any, Any]:
    columns = _names(source)
    if columns is not None:
        opening, load, *_ = columns_of(name, columns, reading)
        return source[columns[opening]], source[columns[load]]
    if reading.opening is not None or reading.load is not None:
        raise TypeError(f"{name}_as: columns are chosen in a file or a table, got {type(source).__name__}")
    if hasattr(source, "opening") and hasattr(source, "load"):
        return source.opening, source.load
    if not (isinstance(source, Sequence | np.ndarray) and len(source) == 2):
        what = f"an array of shape {source.shape}" if isinstance(source, np.ndarray) else type(source).__name__
        raise TypeError(f"{name}: must be (opening, load), a table with these columns, or a path, got {what}")
    return source[0], source[1]


def _names(source: Any) -> list[Any] | None:
    """The names of the columns; None where columns have no names."""
    if isinstance(source, Mapping):
        return list(source)
    if isinstance(source, np.ndarray):
        return list(source.dtype.names) if source.dtype.names else None
    return list(source.columns) if hasattr(source, "columns") else None


def _numbers(name: str, values: Any) -> np.ndarray:
    try:
        array = np.asarray(values)
        if array.dtype.kind not in "iufO":
            raise TypeError(f"{name}: must be real numbers, got {array.dtype}")
        array = array.astype(float)
    except (TypeError, ValueError) as error:
        raise type(error)(str(error) if str(error).startswith(name) else f"{name}: must be numbers, {error}") from None
    if array.ndim != 1:
        raise CurveError(f"{name}: must be of one dimension, got shape {array.shape}")
    return array
