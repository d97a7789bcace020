"""Plug-in of pytest: the fixture `curve_regression`, which holds a load-opening curve to a file beside the test.

It is loaded wherever debond is installed, so that it imports nothing before the fixture is used.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

TYPE_CHECKING = False
if TYPE_CHECKING:
    from verify.testing import CurveLike, Reading


def pytest_addoption(parser: pytest.Parser) -> None:
    what = "let curve_regression write the curves that it is given, in place of those it would compare them with"
    parser.getgroup("debond").addoption("--update-curves", action="store_true", help=what)


@pytest.fixture
def curve_regression(request: pytest.FixtureRequest) -> CurveRegression:
    """Hold a curve to the CSV file that is kept beside the test; see `CurveRegression.__call__`."""
    return CurveRegression(request.path, request.node.name, request.config.getoption("--update-curves"))


class CurveRegression:
    """Compares curves of one test with files in the folder NAME_OF_TEST_FILE beside it."""

    def __init__(self, file: Path, test: str, update: bool) -> None:
        self._folder, self._test, self._update = file.with_suffix(""), test, update
        self._used: set[Path] = set()

    def __call__(
        self, curve: CurveLike, name: str | None = None, *, rel: float = 1e-3, reading: Reading | None = None
    ) -> None:
        """Fail unless the curve, its peak load and its work are within ``rel`` of those in the file.

        Parameters
        ----------
        curve : a result, a pair of arrays, a table, a text file or the folder of a run
        name : of the file, where a test compares several curves; default: the name of the test
        rel : relative tolerance of the curve, its peak load and its work
        reading : which columns of ``curve`` are opening and load, and what they are multiplied by

        Raises
        ------
        AssertionError : they differ by more, with a table; or there is no file yet, with what to run.
        ValueError, TypeError : ``curve`` is no curve, ``rel`` no tolerance, or ``name`` that of a curve before it.
        """
        __tracebackhide__ = True
        from debond import own

        testing = own("verify.testing")
        file = self._folder / (re.sub(r"[^\w.-]+", "_", name or self._test) + ".csv")
        if file in self._used:
            raise ValueError(f"name: must be another one for each curve of a test, got {name or self._test!r} again")
        self._used.add(file)
        opening, load = testing.points("curve", curve, reading)
        if self._update:
            file.parent.mkdir(parents=True, exist_ok=True)
            rows = (f"{d:.17g},{P:.17g}" for d, P in zip(opening + 0.0, load + 0.0, strict=True))  # no -0
            file.write_text("\n".join(["opening,load", *rows, ""]))
        elif not file.exists():
            raise AssertionError(f"{file}: is missing; run pytest --update-curves once, look at the file, and keep it")
        testing.assert_curves_close((opening, load), file, curve=rel, peak=rel, energy=rel)
