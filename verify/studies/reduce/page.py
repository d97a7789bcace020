"""A reduction as a page: the curve, the R-curves, the table, and what was corrected."""

from __future__ import annotations

from pathlib import Path

from verify.pages.template import rendered
from verify.pages.text import Units, quantity
from verify.reduction.reduce import Reduction
from verify.scene.schema import Scene
from verify.studies.reduce import figures
from verify.studies.reduce.bias import Bias
from verify.studies.reduce.fit import Fit
from verify.studies.reduce.wording import HEADS, cells, facts, remarks


def write(
    found: Reduction, known: tuple[Bias, ...], scene: Scene, source: str, path: Path, fit: Fit | None = None
) -> None:
    """Write the page.

    Parameters
    ----------
    source : the file that was reduced
    """
    units = Units.of(scene.units)
    made = (figures.curve(found, units, "reduce-curve", fit), figures.r_curves(found, known, units, "reduce-growth"))
    page = rendered(
        "verify.studies.reduce",
        "page.html.j2",
        {},
        source=Path(source).name,
        sentence=_specimen(found, scene, units),
        unit=units.toughness,
        panels=[one for one in made if one is not None],
        heads=(*HEADS, "against input") if known else HEADS,
        rows=[(one, cells(one, known)) for one in found.schemes if not one.missing],
        missing=[one for one in found.schemes if one.missing],
        facts=facts(found),
        remarks=remarks(found),
        fit=fit,
    )
    path.write_text(page, encoding="utf-8")


def _specimen(found: Reduction, scene: Scene, units: Units) -> str:
    """The specimen in words: "A dcb of the scene mine: arms 1.56 mm thick, 25.4 mm wide, precrack 32.9 mm."."""
    of = found.coupon
    thick = " and ".join(quantity(h, units.length) for h in dict.fromkeys(of.thickness))
    sizes = (
        f"arms {thick} thick, {quantity(of.width, units.length)} wide, precrack {quantity(of.precrack, units.length)}"
    )
    return f"The {of.kind} specimen of the scene {scene.name}: {sizes}."
