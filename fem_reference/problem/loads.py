"""Loads and supports of the general specimen: what acts on a part of an arm's outline."""

from __future__ import annotations

from typing import NamedTuple

from fem_reference.problem.specimen import LOWER, UPPER, Action, Body, Patch, Region


class Load(NamedTuple):
    """A part of the load as a uniform dead traction: the force ``share`` times the load parameter, upwards.

    ``body`` is 0 (upper), 1 (lower) or None: the end faces of both as one. ``side`` is "left", "right", "top" or
    "bottom", ``extent`` the range of X on top or bottom, by default the whole side. With ``couple`` the traction on an
    end face is horizontal, linear in Y about its mid height, and ``share`` is its moment, anticlockwise.
    """

    body: int | None
    side: str
    share: float
    extent: tuple[float, float] | None = None
    couple: bool = False


class Support(NamedTuple):
    """A patch whose mean vertical displacement is zero; with ``couple`` an end face whose mean rotation is zero.

    Fields as in `Load`.
    """

    body: int | None
    side: str
    extent: tuple[float, float] | None = None
    couple: bool = False


def action(on: Load | Support, bodies: tuple[Body, Body], factor: float) -> Action:
    """The unit traction of a load or support, with its factor.

    Raises
    ------
    ValueError : an unknown side, a part that is no end face where one is needed, or an extent outside the arm.
    """
    name = type(on).__name__.lower() + "s"
    if on.side not in ("left", "right", "top", "bottom"):
        raise ValueError(f"{name}: must have the side left, right, top or bottom, got {on.side}")
    if on.side in ("top", "bottom") and (on.couple or on.body is None):
        raise ValueError(f"{name}: must have the side left or right for a couple or for both bodies, got {on.side}")
    numbers = (UPPER, LOWER) if on.body is None else (on.body,)
    patches = tuple(Patch(number, _place(on, bodies[number], name)) for number in numbers)
    if on.side in ("top", "bottom"):
        (low, high), _ = patches[0].place
        return Action(patches, push=1.0 / (high - low), turn=0.0, middle=0.0, factor=factor)
    ends = [Y for patch in patches for Y in patch.place[1]]
    low, high = min(ends), max(ends)
    if on.couple:
        return Action(patches, push=0.0, turn=12.0 / (high - low) ** 3, middle=0.5 * (low + high), factor=factor)
    return Action(patches, push=1.0 / (high - low), turn=0.0, middle=0.0, factor=factor)


def _place(on: Load | Support, body: Body, name: str) -> Region:
    bottom, top = float(body.Y[0]), float(body.Y[-1])
    if on.side in ("left", "right"):
        X = 0.0 if on.side == "left" else body.length
        return (X, X), (bottom, top)
    low, high = on.extent or (0.0, body.length)
    if not 0.0 <= low < high <= body.length * (1.0 + 1e-12):
        raise ValueError(f"{name}: must have an extent in 0 to {body.length}, from left to right, got {low}, {high}")
    Y = top if on.side == "top" else bottom
    return (low, high), (Y, Y)
