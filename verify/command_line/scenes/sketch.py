"""An ASCII drawing of a specimen: bodies, bond, supports, load, lengths."""

from __future__ import annotations

from collections.abc import Iterable

from verify.scene.schema import Scene
from verify.scene.specimens.delamination import Delamination, Load, Support

#: Width of the notes to the right of a drawing.
NOTES = 16
#: Lines of a body at most: the thinner one has one, the other so many times more.
MOST_ROWS = 5


def sketch(scene: Scene, width: int) -> list[str]:
    """Lines of at most ``width`` characters (40 at least) in ASCII."""
    specimen, longest = scene.specimen, max(scene.specimen.lengths)
    room = min(max(width, 40), 100) - NOTES - 4
    tip, *ends = (min(max(round(length / longest * room), 1), room) for length in (specimen.tip, *specimen.lengths))
    forward = specimen.tip > specimen.loaded_at
    start, end = (tip, ends[0]) if forward else (0, tip)
    if not forward:
        ends[0] = max(ends[0], tip + 2)  # the free end can be seen
    bond = f" {'':{start}}{':' * (end - start)}{' ' * (end == max(ends))}  bond"
    upper, lower = (
        [f"+{'-' * n}+", f"|{'':{n}}|  {h:.4g} thick", *[f"|{'':{n}}|"] * (rows - 1), f"+{'-' * n}+"]
        for n, h in zip(ends, specimen.thicknesses, strict=True)
        for rows in [min(round(h / min(specimen.thicknesses)), MOST_ROWS)]
    )
    lines = ["opening " + " -> ".join(f"{opening:.4g}" for opening in scene.load.opening)]
    lines += [*_acting(specimen, 0, ends), *upper, _marked(bond, specimen, _under(specimen, 0), ends), *lower]
    lines += _acting(specimen, 1, ends)
    lines += [f" {'/' * ends[clamp.body]}  fixed" for clamp in specimen.clamps if clamp.side == "bottom"]
    if under := list(_under(specimen, 1)):
        lines.append(f"{_marked('', specimen, under, ends):{room + 2}}  o: supports")
    if any(support.couple for support in specimen.supports if support.body is None):
        lines.append(f"{'':{room}} |  guided")
    measured = {(specimen.tip, tip), *zip(specimen.lengths, ends, strict=True)}
    lines += [_measure(n, f" {length:.4g} ") for length, n in sorted(measured)]
    return ["  " + line.rstrip() for line in lines]


def _acting(specimen: Delamination, body: int, ends: list[int]) -> list[str]:
    """A line with a mark for every load on a body: an arrow of a force, @ of a couple."""
    found = [load for load in specimen.loads if (load.body or 0) == body]
    return [_marked("", specimen, found, ends)] if found else []


def _under(specimen: Delamination, body: int) -> Iterable[Support]:
    return (one for one in specimen.supports if one.body == body)


def _marked(line: str, specimen: Delamination, patches: Iterable[Load | Support], ends: list[int]) -> str:
    """A line with a sign in the middle of each patch."""
    letters = list(f"{line:{max(ends) + 2}}")
    for one in patches:
        body = one.body or 0
        sign = "o" if isinstance(one, Support) else "@" if one.couple else "^" if one.share > 0.0 else "v"
        letters[1 + round(specimen.middle(one) / specimen.lengths[body] * (ends[body] - 1))] = sign
    return "".join(letters)


def _measure(end: int, label: str) -> str:
    """|<--- 14 --->| or, where the number does not fit, the number behind the line."""
    return f"|{'-' * end}|{label}" if end - 2 < len(label) else f"|<{label:-^{end - 2}}>|"
