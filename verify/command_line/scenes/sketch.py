"""An ASCII drawing of a specimen: bodies, bond, supports, load, lengths."""

from __future__ import annotations

from collections.abc import Mapping

from verify.scene.schema import Scene
from verify.scene.specimens.delamination import Delamination, Load, Support

#: Width of the notes to the right of a drawing.
NOTES = 16


def sketch(scene: Scene, width: int) -> list[str]:
    """Lines of at most ``width`` characters (40 at least) in ASCII."""
    room = min(max(width, 40), 100) - NOTES - 4
    specimen, longest = scene.specimen, max(scene.specimen.lengths)
    tip, *ends = (_share(length / longest, room) for length in (specimen.tip, *specimen.lengths))
    forward = specimen.tip > specimen.loaded_at
    start, end = (tip, ends[0]) if forward else (0, tip)
    if not forward:
        ends[0] = max(ends[0], tip + 2)  # the free end can be seen
    bond = f" {'':{start}}{':' * (end - start)}{' ' * (end == max(ends))}  bond"
    upper, lower = (
        [_edge(n), f"|{'':{n}}|  {_short(thickness)} thick", _edge(n)]
        for n, thickness in zip(ends, specimen.thicknesses, strict=True)
    )
    if specimen.slides:
        lines = [*_acting(scene, 0, room), *upper, _carried(specimen, 0, bond, room), *lower]
        lines += [*_acting(scene, 1, room), *_feet(specimen, room)]
    else:
        lines = [*_loads(scene, 0, ends[0]), *upper, bond, *lower, *_loads(scene, 1, ends[1])]
        lines += _clamps(specimen, ends)
    measured = {(specimen.tip, tip), *zip(specimen.lengths, ends, strict=True)}
    lines += [_measure(0, n, length) for length, n in sorted(measured)]
    return ["  " + line.rstrip() for line in lines]


def _loads(scene: Scene, body: int, end: int) -> list[str]:
    """The arrow of the load on a body, with the programme beside that of the upper one."""
    found = [load for load in scene.specimen.loads if load.body == body]
    if not found:
        return []
    arrow, programme = "^" if found[0].share > 0.0 else "v", " opening " + " -> ".join(map(_short, scene.load.opening))
    if body == 1:
        return [arrow]
    if found[0].side == "left" or len(programme) >= end:
        return [arrow + programme]
    return [f"{programme.strip():>{end}} {arrow}"]


def _clamps(specimen: Delamination, ends: list[int]) -> list[str]:
    return [f" {'/' * ends[clamp.body]}  fixed" for clamp in specimen.clamps if clamp.side == "bottom"]


def _acting(scene: Scene, body: int, room: int) -> list[str]:
    """A mark for every load on a body: an arrow of a force, @ of a couple; with the programme above the upper one."""
    marks = {}
    for load in scene.specimen.loads:
        if (load.body or 0) == body:
            marks[_column(scene.specimen, load, room)] = "@" if load.couple else "^" if load.share > 0.0 else "v"
    programme = ["opening " + " -> ".join(map(_short, scene.load.opening))] if body == 0 else []
    return [*programme, *([_marked(" " * (room + 2), marks)] if marks else [])]


def _carried(specimen: Delamination, body: int, line: str, room: int) -> str:
    """A line below a body with its supports in it."""
    return _marked(line, {_column(specimen, one, room): "o" for one in specimen.supports if one.body == body})


def _feet(specimen: Delamination, room: int) -> list[str]:
    """Supports below the lower body, and what an end is held by."""
    feet = _carried(specimen, 1, " " * (room + 2), room).rstrip()
    turns = [support.couple for support in specimen.supports if support.body is None]
    held = [f"{'':{room}} |  guided"] if any(turns) else []
    return [f"{feet:{room + 2}}  o: supports"] * bool(feet) + held


def _column(specimen: Delamination, patch: Load | Support, room: int) -> int:
    """Where the middle of a patch is in a line."""
    length = max(specimen.lengths)
    end = 0.0 if patch.side == "left" else length
    X = end if patch.extent is None else sum(patch.extent) / 2
    return 1 + round(X / length * (room - 1))


def _marked(line: str, marks: Mapping[int, str]) -> str:
    letters = list(line)
    for column, mark in marks.items():
        letters[column] = mark
    return "".join(letters)


def _edge(room: int) -> str:
    return f"+{'-' * room}+"


def _measure(start: int, end: int, length: float) -> str:
    """|<--- 14 --->| or, where the number does not fit, the number behind the line."""
    label = f" {_short(length)} "
    inside = end - start - 2
    if inside < len(label):
        return f"{'':{start}}|{'-' * (end - start)}|{label}"
    return f"{'':{start}}|<{label:-^{inside}}>|"


def _share(part: float, room: int) -> int:
    return min(max(round(part * room), 1), room)


def _short(value: float) -> str:
    return f"{value:.4g}"
