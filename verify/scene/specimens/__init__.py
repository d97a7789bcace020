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


def _found() -> dict[str, type[Delamination]]:
    for module in iter_modules(__path__):
        import_module(f"{__name__}.{module.name}")
    found = {kind: one for one in _all_of(Delamination) for kind in _kinds(one)}
    return dict(sorted(found.items(), key=lambda pair: (pair[1].slides, pair[0])))


def _all_of(specimen: type[Delamination]) -> Iterator[type[Delamination]]:
    """All direct and indirect subclasses."""
    for one in specimen.__subclasses__():
        yield from (one, *_all_of(one))


def _kinds(specimen: type[Delamination]) -> tuple[str, ...]:
    """The name of this kind in a scene; none for a base class of several specimens."""
    found = specimen.model_fields.get("kind")
    return get_args(found.annotation) if found is not None else ()


#: The specimens by their kind.
SPECIMENS: Mapping[str, type[Delamination]] = _found()


def specimen_kind(value: object) -> str | None:
    """The kind of a specimen in angle brackets, as it is told from keys in an error."""
    kind = value.get("kind") if isinstance(value, Mapping) else getattr(value, "kind", None)
    return f"<{kind}>" if isinstance(kind, str) else None


if TYPE_CHECKING:
    Specimen: TypeAlias = Delamination
else:
    _TAGGED = (Annotated[specimen, Tag(f"<{kind}>")] for kind, specimen in SPECIMENS.items())
    Specimen = Annotated[reduce(or_, _TAGGED), Discriminator(specimen_kind)]
