"""What ``import verify`` offers, and what it costs."""

import subprocess
import sys

import pytest

import verify


def test_every_name_is_there():
    assert all(getattr(verify, name) is not None for name in verify.__all__) and set(verify.__all__) <= set(dir(verify))
    assert len(verify.__all__) == len(set(verify.__all__)) < 20
    with pytest.raises(AttributeError, match="no attribute 'scenes'"):
        verify.scenes  # noqa: B018


@pytest.mark.parametrize("package", ["verify", "verify.scene"])
def test_the_import_brings_no_library_along(package):
    program = f"import sys; before = set(sys.modules); import {package}; print(*(set(sys.modules) - before))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    new = done.stdout.split()
    assert len(new) < 12 and {"numpy", "pydantic", "scipy", "matplotlib"}.isdisjoint(new)


def test_no_public_name_is_that_of_a_package():
    """An import of the package would put itself in the place of the name."""
    folder = list(verify.__path__)[0]
    program = f"import verify, pkgutil; print(*(m.name for m in pkgutil.iter_modules([{folder!r}])))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert set(done.stdout.split()).isdisjoint(verify.__all__)


def test_old_places_stay_valid():
    from verify import testing
    from verify.result import Result
    from verify.scene import Scene

    assert verify.Scene is Scene and verify.Result is Result
    assert verify.assert_curves_close is testing.assert_curves_close
