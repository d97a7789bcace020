"""The law to be judged: a function in a module or a Python file, or a file of tractions."""

from __future__ import annotations

import importlib
import importlib.util
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from verify.studies.law.given.answer import Answer, LawError, PointLaw, of_function
from verify.studies.law.given.read import PathColumns, read_paths
from verify.studies.law.ways.legs import JumpPath


def is_function(text: str) -> bool:
    """Whether a text names a function, ``module:function`` or ``file.py:function``, and not a file."""
    module, colon, name = text.rpartition(":")
    return bool(colon) and name.isidentifier() and bool(module) and not Path(text).exists()


def answered(
    text: str, ways: Sequence[JumpPath], columns: PathColumns
) -> tuple[tuple[JumpPath, ...], dict[str, Answer]]:
    """The paths and the tractions on them of a law that is named on the command line.

    Raises
    ------
    Refusal : no such module, function or file, or one that gives no tractions.
    """
    if not is_function(text):
        return read_paths(Path(text), ways, columns)
    if columns.names or columns.scales:
        raise LawError(f"--columns, --scales: must be left out with a function, got them with {text}")
    law = function(text)
    return tuple(ways), {way.name: of_function(law, way, text) for way in ways}


def function(text: str) -> PointLaw:
    """The function that ``module:function`` or ``file.py:function`` names; modules of the present folder are found."""
    place, _, name = text.rpartition(":")
    module = _module(text, place)
    found = getattr(module, name, None)
    if not callable(found):
        what = "nothing" if found is None else type(found).__name__
        raise LawError(f"{text}: {place} must have a function {name}, got {what}")
    return found


def _module(text: str, place: str) -> Any:
    """The module, imported; a file is run under a name of its own."""
    before = list(sys.path)
    try:
        if place.endswith(".py"):
            if not Path(place).is_file():
                raise LawError(f"{text}: must name a function in a file or a module, got no file {place}")
            spec = importlib.util.spec_from_file_location(f"law_{Path(place).stem}", place)
            if spec is None or spec.loader is None:
                raise LawError(f"{text}: {place} cannot be imported")
            module = importlib.util.module_from_spec(spec)
            sys.path.insert(0, str(Path(place).resolve().parent))
            spec.loader.exec_module(module)
            return module
        sys.path.insert(0, str(Path.cwd()))
        return importlib.import_module(place)
    except LawError:
        raise
    except (Exception, SystemExit) as error:
        raise LawError(f"{text}: {place} cannot be imported: {_last_line(error)}") from None
    finally:
        sys.path[:] = before


def _last_line(error: BaseException) -> str:
    """Where the user's code failed, and the error."""
    own = [at for at in traceback.extract_tb(error.__traceback__) if "importlib" not in at.filename]
    where = f"{own[-1].filename}:{own[-1].lineno}: " if len(own) > 1 else ""
    return f"{where}{type(error).__name__}: {' '.join(str(error).split())[:200]}"
