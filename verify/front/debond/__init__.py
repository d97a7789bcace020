"""One import for all of debond: the public names of `verify`, and the packages `iga` and `verify` themselves.

Each name is imported when it is first used. The package stands in a folder of its own, as its name in the root of the
project is that of the launcher.
"""

import sys
from importlib import import_module
from types import ModuleType

TYPE_CHECKING = False  # type checkers take a name like this for true; that of `typing` costs milliseconds
if TYPE_CHECKING:
    import iga as iga
    import verify as verify
    from verify import (
        Check,
        Comparison,
        Reading,
        Result,
        Scene,
        __version__,
        assert_curves_close,
        compare,
        known_methods,
        load_scene,
        packaged_scenes,
        read_curve,
        run_checks,
        solve,
        verify_scenes,
        write_report,
    )

__all__ = [
    "__version__",
    "assert_curves_close",
    "Check",
    "compare",
    "Comparison",
    "iga",
    "known_methods",
    "load_scene",
    "packaged_scenes",
    "read_curve",
    "Reading",
    "Result",
    "run_checks",
    "Scene",
    "solve",
    "verify",
    "verify_scenes",
    "write_report",
]


def main() -> int:
    """The command `debond`; its exit code."""
    try:
        own("iga")
        command = own("verify.__main__").program
    except ImportError as error:
        sys.stderr.write(f"debond: {error}\n")
        return 3
    code: int = command()
    return code


def own(name: str) -> ModuleType:
    """A module of `iga` or `verify`, as they are in debond.

    Raises
    ------
    ImportError : another package or file of this name is found first.
    """
    found = import_module(top := name.partition(".")[0])
    if not hasattr(found, "_HOMES"):
        file = getattr(found, "__file__", None) or ", ".join(found.__path__)
        text = f"{top}: must be the package of debond, got {file}, which shadows it; rename, move or uninstall that one"
        raise ImportError(text, name=top, path=file)
    return import_module(name)


if not TYPE_CHECKING:  # a type checker knows the names above and no others

    def __getattr__(name: str) -> object:
        if name not in __all__:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return own(name) if name in ("iga", "verify") else getattr(own("verify"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
