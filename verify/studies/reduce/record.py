"""What `debond reduce` writes: reduce.json, and the R-curve in reduce.csv."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from verify.reduction.reduce import LEVEL, Reduced, Reduction, Value
from verify.studies.reduce.bias import Bias
from verify.studies.reduce.fit import Fit
from verify.version import __version__

NUMBERS_FILE, CURVE_FILE, REDUCTION_PAGE = "reduce.json", "reduce.csv", "reduce.html"


@dataclass(frozen=True)
class RCurveRow:
    """A point of the R-curve of a scheme: crack growth, G, and G_II / G, NaN where that is not known."""

    scheme: str
    growth: float
    G: float
    sliding: float


def curve(found: Reduction) -> Iterator[RCurveRow]:
    """The R-curves of all schemes."""
    for one in found.schemes:
        for growth, G, sliding in zip(one.growth, one.G, one.sliding, strict=True):
            yield RCurveRow(one.name, float(growth), float(G), float(sliding))


def content(found: Reduction, known: Sequence[Bias], scene: str, source: str, fit: Fit | None = None) -> dict[str, Any]:
    """The content of reduce.json; unknown values become null."""
    points = {
        name: {"opening": found.smoothed.opening[i], "load": found.smoothed.load[i], "point": i + 1}
        for name, i in found.points.items()
    }
    return {
        "file": source,
        "scene": scene,
        "specimen": asdict(found.coupon),
        "settings": asdict(found.settings),
        "linear_part": {"compliance": found.part.compliance, "toe": found.toe, "noise": found.part.noise},
        "level": LEVEL,
        "initiation_points": points,
        "rows_of_growth": int(np.count_nonzero(found.grown)),
        **({} if fit is None else {"fit": _fit(fit)}),
        "schemes": {one.name: _scheme(one, known) for one in found.schemes},
        "version": __version__,
    }


def _fit(fit: Fit) -> dict[str, Any]:
    return {**_values(fit.values), "misfit": fit.misfit, "solutions": fit.solutions, "sentences": fit.sentences}


def _scheme(one: Reduced, known: Sequence[Bias]) -> dict[str, Any]:
    if one.missing:
        return {"missing": one.missing}
    bias = next((bias for bias in known if bias.scheme is one), None)
    against = {} if bias is None else {"input": bias.known, "bias": bias.propagation}
    return {
        "what": one.what,
        "constants": _values(one.constants),
        "initiation": _values(one.initiation),
        "propagation": {**_value(one.propagation), "scatter": one.scatter, "rows": one.count},
        "G_II/G": one.mixture,
        **against,
    }


def _values(values: Mapping[str, Value]) -> dict[str, dict[str, float]]:
    return {key: _value(value) for key, value in values.items()}


def _value(value: Value) -> dict[str, float]:
    """A value with the half width of its interval."""
    return {"value": value.value, "half_width": value.half}
