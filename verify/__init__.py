"""Scenes, methods, checks and reports: one problem solved by independent codes and compared.

The public names are those of `__all__`; each is imported when it is first used, so that ``import verify`` stays cheap.
"""

from importlib import import_module

from verify.version import __version__

TYPE_CHECKING = False  # type checkers take a name like this for true; that of `typing` costs milliseconds
if TYPE_CHECKING:
    from verify.checks.identities import run_checks
    from verify.curves.compare import Comparison
    from verify.curves.read import Reading, read_curve
    from verify.face import compare, verify_scenes, write_report
    from verify.methods.plugins import known_methods
    from verify.methods.solve import solve
    from verify.result import Result
    from verify.scene.load import load_scene, packaged_scenes
    from verify.scene.schema import Scene
    from verify.testing import assert_curves_close
    from verify.verdict import Check

__all__ = [
    "__version__",
    "assert_curves_close",
    "Check",
    "compare",
    "Comparison",
    "known_methods",
    "load_scene",
    "packaged_scenes",
    "read_curve",
    "Reading",
    "Result",
    "run_checks",
    "Scene",
    "solve",
    "verify_scenes",
    "write_report",
]

#: Name -> module.
_HOMES = {
    "Check": "verdict",
    "Comparison": "curves.compare",
    "Reading": "curves.read",
    "Result": "result",
    "Scene": "scene.schema",
    "assert_curves_close": "testing",
    "compare": "face",
    "known_methods": "methods.plugins",
    "load_scene": "scene.load",
    "packaged_scenes": "scene.load",
    "read_curve": "curves.read",
    "run_checks": "checks.identities",
    "solve": "methods.solve",
    "verify_scenes": "face",
    "write_report": "face",
}

if not TYPE_CHECKING:  # a type checker knows the names above and no others

    def __getattr__(name: str) -> object:
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
