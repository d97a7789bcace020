"""The schemes of every kind of specimen, in the order of tables."""

from __future__ import annotations

from collections.abc import Callable

from verify.reduction import calibration, dcb
from verify.reduction.equivalent_crack import by_j, cbbm, cbt
from verify.reduction.scheme import Fitted, Setting

Scheme = Callable[[Setting], Fitted]

_OPENED: dict[str, Scheme] = {"MBT": dcb.mbt, "CC": dcb.cc, "MCC": dcb.mcc, "CBT": cbt, "CBBM": cbbm, "J": by_j}
_BENT: dict[str, Scheme] = {"CC": calibration.cc, "CBT": cbt, "CBBM": cbbm, "J": by_j}

#: Kind -> name -> scheme.
SCHEMES: dict[str, dict[str, Scheme]] = {
    "dcb": _OPENED,
    "adcb": _OPENED,
    "enf": _BENT,
    "els": _BENT,
    "4enf": _BENT,
    "slb": _BENT,
    "mmb": {"D6671": cbt, "CBBM": cbbm, "J": by_j},
}
