"""Scenes: from TOML to a checked, frozen value.

`Scene`, `SceneError`, `load_scene`, `parse_scene` and `packaged_scenes` are the public names; each is imported when it
is first used, so that ``import verify.scene`` stays cheap.
"""

from importlib import import_module

_HOMES = {
    "Scene": "schema",
    "SceneError": "parse",
    "load_scene": "load",
    "packaged_scenes": "load",
    "parse_scene": "parse",
}


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
