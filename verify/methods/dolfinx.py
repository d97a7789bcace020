"""Whether DOLFINx is installed, which versions are supported, and how to get it."""

from __future__ import annotations

import re
import sys
from importlib.util import find_spec

DOLFINX_MISSING = "not run: DOLFINx is not installed"
DOLFINX_WAYS = (
    "conda: conda install -c conda-forge fenics-dolfinx",
    "Docker: docker run -ti -v $PWD:/work -w /work dolfinx/dolfinx:stable",
    "Debian 13 or Ubuntu: apt install python3-dolfinx-real; as any user, ./debond builds itself a private Debian",
)

#: The first and the last DOLFINx that the model is written for, as major and minor version.
OLDEST, NEWEST = (0, 9), (0, 11)


def dolfinx_installed() -> bool:
    """Whether DOLFINx can be imported, without importing it."""
    return find_spec("dolfinx") is not None


def supported(found: str) -> bool:
    """Whether the model is written for a version of DOLFINx."""
    numbers = re.match(r"(\d+)\.(\d+)", found)
    return numbers is not None and OLDEST <= (int(numbers[1]), int(numbers[2])) <= NEWEST


def another_dolfinx() -> str:
    """Where an error comes from if the installed DOLFINx is not a supported version, whose calls may be missing or
    different; empty for a supported version."""
    found = str(getattr(sys.modules.get("dolfinx"), "__version__", ""))
    if not found or supported(found):
        return ""
    oldest, newest = (".".join(map(str, numbers)) for numbers in (OLDEST, NEWEST))
    return f"DOLFINx {found}, or for it: debond takes {oldest} to {newest}, see debond doctor"
