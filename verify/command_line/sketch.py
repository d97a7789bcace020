"""An ASCII drawing of a specimen: bodies, bond, supports, load, lengths."""

from __future__ import annotations

from verify.scene.bodies import Dcb, Peel
from verify.scene.schema import Scene

#: Width of the notes to the right of a drawing.
NOTES = 16


def sketch(scene: Scene, width: int) -> list[str]:
    """Lines of at most ``width`` characters (40 at least) in ASCII."""
    room = min(max(width, 40), 100) - NOTES - 4
    return _peel(scene, scene.specimen, room) if scene.specimen.kind == "peel" else _dcb(scene, scene.specimen, room)


def _dcb(scene: Scene, specimen: Dcb, room: int) -> list[str]:
    crack = _share(specimen.precrack / specimen.length, room)
    arm = [_edge(room), f"|{'':{room}}|  {_short(specimen.arm_thickness)} thick", _edge(room)]
    lines = ["^" + _programme(scene), *arm, f" {'':{crack}}{':' * (room - crack)}   bond", *arm, "v"]
    lines += [_measure(0, crack, specimen.precrack), _measure(0, room, specimen.length)]
    return ["  " + line.rstrip() for line in lines]


def _peel(scene: Scene, specimen: Peel, room: int) -> list[str]:
    longest = max(specimen.strip_length, specimen.substrate_length)
    strip, substrate, bond = (
        _share(length / longest, room)
        for length in (specimen.strip_length, specimen.substrate_length, specimen.bond_length)
    )
    strip = max(strip, bond + 2)
    load = _programme(scene)
    lines = [f"{load.strip():>{strip}} ^" if len(load) < strip else f"^{load}"]
    lines += [_edge(strip), f"|{'':{strip}}|  {_short(specimen.strip_thickness)} thick", _edge(strip)]
    lines += [f" {':' * bond}  bond", _edge(substrate)]
    lines += [f"|{'':{substrate}}|  {_short(specimen.substrate_thickness)} thick", _edge(substrate)]
    lines += [f" {'/' * substrate}  fixed", _measure(0, bond, specimen.bond_length)]
    lines += [
        _measure(0, substrate, specimen.substrate_length),
        _measure(0, strip, specimen.strip_length),
    ]
    return ["  " + line.rstrip() for line in lines]


def _programme(scene: Scene) -> str:
    return " opening " + " -> ".join(map(_short, scene.load.opening))


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
