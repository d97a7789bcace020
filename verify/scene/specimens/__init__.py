"""The specimens of a scene by their kind: every class in a file of this folder that names one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import reduce
from importlib import import_module
from operator import or_
from pkgutil import iter_modules
from typing import TYPE_CHECKING, Annotated, TypeAlias, get_args

from pydantic import Discriminator, Tag

from verify.scene.specimens.delamination import Delamination


def _below(specimen: type[Delamination]) -> Iterator[tuple[str, type[Delamination]]]:
    """Kinds and types of all subclasses; one without the name of a kind is a base class of several."""
    for one in specimen.__subclasses__():
        kind = one.model_fields.get("kind")
        yield from ((name, one) for name in get_args(kind.annotation if kind else None))
        yield from _below(one)


for _module in iter_modules(__path__):
    import_module(f"{__name__}.{_module.name}")

#: The specimens by their kind.
SPECIMENS: Mapping[str, type[Delamination]] = dict(
    sorted(_below(Delamination), key=lambda pair: (pair[1].slides, pair[0]))
)


def specimen_kind(value: object) -> str | None:
    """The kind of a specimen in angle brackets, as it is told from keys in an error."""
    kind = value.get("kind") if isinstance(value, Mapping) else getattr(value, "kind", None)
    return f"<{kind}>" if isinstance(kind, str) else None


if TYPE_CHECKING:
    Specimen: TypeAlias = Delamination
else:
    _TAGGED = (Annotated[specimen, Tag(f"<{kind}>")] for kind, specimen in SPECIMENS.items())
    Specimen = Annotated[reduce(or_, _TAGGED), Discriminator(specimen_kind)]
