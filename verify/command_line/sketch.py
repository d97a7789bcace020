"""An ASCII drawing of a specimen: bodies, bond, supports, load, lengths."""

from __future__ import annotations

from verify.scene.schema import Scene
from verify.scene.specimens.delamination import Delamination

#: Width of the notes to the right of a drawing.
NOTES = 16


def sketch(scene: Scene, width: int) -> list[str]:
    """Lines of at most ``width`` characters (40 at least) in ASCII."""
    room = min(max(width, 40), 100) - NOTES - 4
    specimen, longest = scene.specimen, max(scene.specimen.lengths)
    tip, *ends = (_share(length / longest, room) for length in (specimen.tip, *specimen.lengths))
    start, end = (tip, ends[0]) if specimen.loaded_at == 0.0 else (0, tip)
    if specimen.loaded_at:
        ends[0] = max(ends[0], tip + 2)  # the free end can be seen
    bond = f" {'':{start}}{':' * (end - start)}{' ' * (end == max(ends))}  bond"
    upper, lower = (
        [_edge(n), f"|{'':{n}}|  {_short(thickness)} thick", _edge(n)]
        for n, thickness in zip(ends, specimen.thicknesses, strict=True)
    )
    lines = [*_loads(scene, 0, ends[0]), *upper, bond, *lower, *_loads(scene, 1, ends[1]), *_clamps(specimen, ends)]
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
    if found[0].end == "left" or len(programme) >= end:
        return [arrow + programme]
    return [f"{programme.strip():>{end}} {arrow}"]


def _clamps(specimen: Delamination, ends: list[int]) -> list[str]:
    return [f" {'/' * ends[clamp.body]}  fixed" for clamp in specimen.clamps if clamp.side == "bottom"]


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
