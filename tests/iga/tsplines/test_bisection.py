"""Bisected meshes: analysis-suitable whatever is marked, as local as the patches, and cheap."""

import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_tmeshes import bisections, breaks, marked, markings

from iga.tsplines.bisection import Bisection, initial
from iga.tsplines.tspline import faces, tspline_rectangle

some = settings(max_examples=60, deadline=None)


@some
@given(markings(steps=8))
def test_every_sequence_of_markings_stays_suitable(drawn):
    mesh, steps = drawn
    for places in steps:
        mesh = mesh.refined(marked(mesh, places))
        assert mesh.tmesh.suitable


@some
@given(markings(steps=8))
def test_the_closure_is_that_of_the_definition(drawn):
    """All coarser elements that overlap a patch, and so on; and these are coarser by one level only."""
    mesh, steps = drawn
    for places in steps:
        chosen = marked(mesh, places)
        closure, drop = plain_closure(mesh, chosen)
        assert np.array_equal(mesh.closure(chosen), closure) and drop <= 1
        mesh = mesh.refined(chosen)


@pytest.mark.parametrize(("name", "shorter"), [("ACROSS", 0.5), ("ALONG", 1.5)])
def test_a_smaller_patch_would_not_do(monkeypatch, name, shorter):
    """One element less in either direction and extensions meet: the closure is what keeps them apart."""
    assert all(marked_at_will(seed).tmesh.suitable for seed in range(20))
    monkeypatch.setattr(f"iga.tsplines.bisection.{name}", shorter)
    assert not all(marked_at_will(seed).tmesh.suitable for seed in range(20))


@some
@given(bisections(), st.floats(0.0, 1.0, exclude_max=True))
def test_what_was_marked_is_bisected_and_the_rest_keeps_its_elements(mesh, place):
    (e,) = marked(mesh, [place])
    cut = mesh.closure([e])
    assert cut[e] and mesh.level_e[cut].max() == mesh.level_e[e]
    finer = mesh.refined([e])
    rows, kept = set(map(tuple, finer.box_ek)), set(map(tuple, mesh.box_ek[~cut]))
    assert kept <= rows and not rows & set(map(tuple, mesh.box_ek[cut]))
    assert len(finer.level_e) == len(mesh.level_e) + cut.sum()
    s0, s1, t0, t1 = mesh.box_ek[e]
    for_s = mesh.level_e[e] % 2 == 0
    child = (s0, (s0 + s1) / 2, t0, t1) if for_s else (s0, s1, t0, (t0 + t1) / 2)
    assert np.min(np.abs(finer.box_ek - child).max(1)) < 1e-14 * max(np.abs(mesh.box_ek).max(), 1.0)


@some
@given(bisections())
def test_elements_are_the_faces_of_the_tmesh(mesh):
    tmesh, box = mesh.tmesh, faces(mesh.tmesh)
    found = np.concatenate([tmesh.knots_i[box[:, :2]], tmesh.knots_j[box[:, 2:]]], axis=1)
    assert sorted(map(tuple, found)) == sorted(map(tuple, mesh.box_ek))


@some
@given(bisections(), st.lists(st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0)), min_size=1, max_size=20))
def test_points_are_found_in_the_elements_that_hold_them(mesh, places):
    low, high = np.array([[b[n] for b in (mesh.breaks_s, mesh.breaks_t)] for n in (0, -1)])
    x_ni = np.clip(low + (high - low) * np.array(places), low, high)
    s0, s1, t0, t1 = mesh.box_ek[mesh.containing(x_ni)].T
    slack = 1e-14 * np.abs(mesh.box_ek).max()
    s, t = x_ni.T
    assert np.all((s0 - slack <= s) & (s <= s1 + slack) & (t0 - slack <= t) & (t <= t1 + slack))
    middle = (mesh.box_ek[:, [0, 2]] + mesh.box_ek[:, [1, 3]]) / 2
    assert np.array_equal(mesh.containing(middle), np.arange(len(middle)))


@some
@given(breaks(), breaks())
def test_bisecting_everything_twice_halves_the_grid(s, t):
    mesh = initial(s, t)
    for _ in range(2):
        mesh = mesh.refined(np.ones(len(mesh.level_e), dtype=bool))
    halved = initial(*(np.interp(np.arange(0.0, len(x) - 0.5, 0.5), np.arange(len(x)), x) for x in (s, t)))
    assert sorted(map(tuple, mesh.box_ek)) == sorted(map(tuple, halved.box_ek))


def test_refinement_towards_a_corner_adds_elements_in_proportion_to_what_is_marked():
    """Morgenstern, Peterseim 2015: bisected elements over marked ones stay below a constant."""
    mesh, bisected = initial(np.arange(5.0), np.arange(5.0)), []
    for _ in range(24):
        finer = mesh.refined([int(np.argmin(mesh.box_ek[:, 0] + mesh.box_ek[:, 2]))])
        bisected.append(len(finer.level_e) - len(mesh.level_e))
        mesh = finer
    assert mesh.level_e.max() == 24 and mesh.tmesh.suitable
    assert max(bisected) < 60 and np.sum(bisected) < 25 * 24
    assert np.sum(bisected[12:]) == pytest.approx(np.sum(bisected[:12]), rel=0.5)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: initial([0.0, 1.0, 1.0], [0.0, 1.0]), "breaks in s must be two numbers or more that rise"),
        (lambda: initial([0.0, 1.0], [0.0]), "breaks in t"),
        (lambda: initial([0.0, 1.0], [0.0, 1.0]).refined([1]), "elements are 0 to 0, got 1 to 1"),
        (lambda: initial([0.0, 1.0], [0.0, 1.0]).refined([-1]), "elements are 0 to 0, got -1 to -1"),
        (lambda: initial([0.0, 1.0], [0.0, 1.0]).refined([True, False]), "a mask of 1 elements, got 2"),
    ],
)
def test_what_cannot_be_bisected_is_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.slow  # a rate of seconds is worth something on a quiet machine only
def test_fifty_thousand_unknowns_are_built_and_extracted_in_seconds():
    """A mesh refined towards an arc: it grows in both directions, and the time with the number of functions."""
    mesh, meshes = initial(np.arange(5.0), np.arange(5.0)), {}
    while len(mesh.level_e) < 28000:
        radius = np.hypot(*((mesh.box_ek[:, [0, 2]] + mesh.box_ek[:, [1, 3]]) / 2).T)
        size = np.hypot(mesh.box_ek[:, 1] - mesh.box_ek[:, 0], mesh.box_ek[:, 3] - mesh.box_ek[:, 2])
        mesh = mesh.refined(np.abs(radius - 3.0) < 0.7 * size)
        meshes[len(mesh.level_e)] = mesh
    small = next(mesh for size, mesh in meshes.items() if size > 4000)
    (n_small, t_small), (n_large, t_large) = timed(small), timed(mesh)
    assert n_large > 25000 and mesh.level_e.max() >= 16
    assert t_large < 10.0
    rate = np.log(t_large / t_small) / np.log(n_large / n_small)
    assert rate < 1.3, "about 1.1; what is above 1 are the bits of the index plane"


def timed(mesh: Bisection) -> tuple[int, float]:
    """Number of functions, and the least of three times in seconds from elements to extraction operators."""
    seconds = []
    for _ in range(3):
        again = Bisection(mesh.breaks_s, mesh.breaks_t, mesh.corner_ek, mesh.level_e)
        start = time.process_time()
        n_A = len(tspline_rectangle(again.tmesh).P_AI)
        seconds.append(time.process_time() - start)
    return n_A, min(seconds)


def plain_closure(mesh: Bisection, chosen: np.ndarray) -> tuple[np.ndarray, int]:
    """The definition, element by element, and how many levels a patch spans at most."""
    size = np.stack([0.5 ** ((mesh.level_e + 1) // 2), 0.5 ** (mesh.level_e // 2)], -1)
    low, high, middle = mesh.corner_ek, mesh.corner_ek + size, mesh.corner_ek + size / 2
    to_cut, drop = np.zeros(len(size), dtype=bool), 0
    to_cut[chosen] = True
    queue = list(chosen)
    while queue:
        e = queue.pop()
        k = mesh.level_e[e]
        reach = 2.0 ** (-k / 2) * np.array([1.5, 2.5]) if k % 2 == 0 else 2.0 ** (-(k + 1) / 2) * np.array([2.5, 3.0])
        within = np.all((low < middle[e] + reach) & (high > middle[e] - reach), axis=1)
        coarser = np.flatnonzero(within & (mesh.level_e < k))
        drop = max([drop, *(k - mesh.level_e[coarser])])
        queue += [f for f in coarser if not to_cut[f]]
        to_cut[coarser] = True
    return to_cut, drop


def marked_at_will(seed: int) -> Bisection:
    """Four elements of any level bisected, eight times."""
    random, mesh = np.random.default_rng(seed), initial(np.arange(5.0), np.arange(5.0))
    for _ in range(8):
        mesh = mesh.refined(random.integers(0, len(mesh.level_e), 4))
    return mesh
