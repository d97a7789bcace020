"""Settings that hold for all tests."""

import os

# Many small matrices: threads of the BLAS would only get in each other's way.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

from collections.abc import Generator  # noqa: E402
from typing import TypeVar  # noqa: E402

import pytest  # noqa: E402
from hypothesis import settings  # noqa: E402
from skips import complaint  # noqa: E402

# A run on a loaded machine must not fail for its pace, and a failure must come back in the next run.
settings.register_profile("debond", deadline=None, derandomize=True, max_examples=16)
settings.register_profile("random", deadline=None, max_examples=25)  # other cases every time
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "debond"))

os.environ.setdefault("MPLBACKEND", "Agg")

Report = TypeVar("Report", pytest.TestReport, pytest.CollectReport)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """A test that is skipped without being listed has failed."""
    return judged((yield))


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """So has a whole file."""
    return judged((yield))


def judged(report: Report) -> Report:
    """The report, failed where it is of a skip that tests/skips.py does not list."""
    if report.skipped and not hasattr(report, "wasxfail"):
        _, _, reason = report.longrepr
        if said := complaint(reason):
            report.outcome, report.longrepr = "failed", said
    return report


@pytest.fixture
def nothing_certified(monkeypatch):
    """For made-up runs that bear the name of a scene whose certified values they do not have."""
    from verify.checks import certified

    monkeypatch.setattr(certified, "certified", lambda scene: ())
