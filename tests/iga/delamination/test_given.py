"""Meshes that a problem states: those of its specimen are solved on, others refused with both places."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from specimens import PAPER

from iga.bases.names import BASES
from iga.delamination import build
from iga.mesh.extraction import Mesh
from tests.iga.test_peel import PEEL

LENGTH, THICKNESS = PAPER.length, PAPER.arm_thickness


def block(x: tuple[float, float], y: tuple[float, float], elements: int = 35) -> Mesh:
    return BASES["lagrange"].rectangle((2, 2), np.linspace(*x, elements + 1), np.array(y))


def pair(x: tuple[float, float] = (0.0, LENGTH), h: float = THICKNESS, elements: int = 35) -> tuple[Mesh, Mesh]:
    return block(x, (0.0, h), elements), block(x, (-h, 0.0), elements)


UPPER, LOWER = pair()


def curved(mesh: Mesh) -> Mesh:
    """The body with its outer side up to a half farther from the interface, between ends that stay."""
    X, Y = mesh.P_AI.T
    return replace(mesh, P_AI=np.stack([X, Y * (1.0 + 0.5 * np.sin(np.pi * X / LENGTH))], 1))


@pytest.mark.parametrize(
    ("meshes", "words"),
    [
        ((UPPER,), "must be 2, the upper body first, got 1"),
        ((UPPER, LOWER, LOWER), "must be 2, the upper body first, got 3"),
        (pair(h=2 * THICKNESS), "upper body: its left side must run from Y = 0 to 0.2, got 0 to 0.4"),
        ((UPPER, pair(h=2 * THICKNESS)[1]), "lower body: its left side must run from Y = -0.2 to 0, got -0.4 to 0"),
        (pair(elements=33), "upper body: an element boundary on its bottom side must lie at the end of the bond, X = "),
        (pair((1.0, LENGTH + 1.0)), "upper body: its left side must lie on X = 0, got 1"),
        (pair((0.0, 0.5 * LENGTH)), f"upper body: its right side must lie on X = {LENGTH:g}, got {LENGTH / 2:g}"),
        ((LOWER, UPPER), "upper body: its bottom side must lie on Y = 0, got -0.2"),
        ((block((0.0, LENGTH), (0.1, 0.3)), LOWER), "upper body: its bottom side must lie on Y = 0, got 0.1"),
        ((replace(UPPER, chains={}), LOWER), "upper body: must have the sides left, right, bottom, top, got none"),
        ((replace(UPPER, P_AI=UPPER.P_AI * np.nan), LOWER), "upper body: its left side must lie on X = 0, got nan"),
    ],
)
def test_meshes_of_another_specimen_are_refused(meshes, words):
    with pytest.raises(ValueError, match=f"^meshes: {words}"):
        build(replace(PAPER, meshes=meshes))


def test_a_face_that_ends_before_its_body_is_refused():
    bottom = UPPER.chains["bottom"]
    part = replace(bottom, **{key: getattr(bottom, key)[:-1] for key in ("block_c", "element_c", "side_c")})
    with pytest.raises(ValueError, match=f"its bottom side must run from X = 0 to {LENGTH:g}, got 0 to"):
        build(replace(PAPER, meshes=(replace(UPPER, chains={**UPPER.chains, "bottom": part}), LOWER)))


def test_bodies_of_a_peel_have_the_thickness_of_the_problem():
    """On the loaded end of the strip and the clamped side of the substrate."""
    h, depth = PEEL.strip_thickness, PEEL.substrate_thickness

    def body(length: float, *y: float) -> Mesh:
        x = np.unique([*np.arange(0.0, length, 5.0), PEEL.bond_length, length])
        return BASES["lagrange"].rectangle((2, 2), x, np.array(y))

    def bodies(h: float, depth: float) -> tuple[Mesh, Mesh]:
        return body(PEEL.strip_length, 0.0, h), body(PEEL.substrate_length, -depth, 0.0)

    build(replace(PEEL, meshes=bodies(h, depth)))
    with pytest.raises(ValueError, match=f"its right side must run from Y = 0 to {h:g}, got 0 to {h / 2:g}"):
        build(replace(PEEL, meshes=bodies(h / 2, depth)))
    with pytest.raises(ValueError, match=f"its bottom side must reach Y = -{depth:g}, got -{depth / 2:g}"):
        build(replace(PEEL, meshes=bodies(h, depth / 2)))


def test_an_outline_is_free_where_nothing_acts_on_it():
    build(replace(PAPER, meshes=(curved(UPPER), curved(LOWER))))
    build(replace(PAPER, meshes=(curved(UPPER),), symmetry=True))
