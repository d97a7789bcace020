"""Meshes of the arms from the number of unknowns: one rule for every basis."""

from dataclasses import replace
from time import process_time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from specimens import PAPER, E

from iga.bases.names import BASES
from iga.dcb import build, solve
from iga.delamination.arms import (
    CRACK_PATH,
    coarsening,
    crack_path,
    division,
    lead,
    tmeshes,
    zone_length,
)
from iga.delamination.meshes import drawn
from iga.delamination.on_base import tmeshes as peel_tmeshes
from iga.interface.surface import surface
from iga.specimen.grading import GRADING
from iga.tsplines.tspline import tspline_rectangle
from tests.iga.test_peel import PEEL

some = settings(max_examples=40, deadline=None)
CZM1 = replace(PAPER, opening=(3.0,))
CZM2 = replace(CZM1, strength=6.0)

LEAST = 400


def missed(basis) -> int:
    """How far the unknowns may miss their aim where single elements count.

    Elements on the path, before and beyond it may all become one more at once: three of one arm with 8 unknowns a
    column; T-splines have three more in both arms or none, and 4 for the halves of one.
    """
    three = 3 * 8 * (basis.columns(3, 2) - basis.columns(3, 1))
    return 2 * three + 4 if basis.local else three


@st.composite
def problems(draw, most=50_000):
    """Specimens as slender as that of the paper or less, openings from half of one at which the crack runs."""
    dofs = round(LEAST * (most / LEAST) ** draw(st.floats(0.0, 1.0)))
    return replace(
        CZM1,
        basis=draw(st.sampled_from(list(BASES))),
        dofs=dofs,
        strength=draw(st.sampled_from([2.0, 4.0, 6.0])),
        opening=(draw(st.floats(1.0, 8.0)),),
        precrack=draw(st.floats(3.0, 5.0)),
        arm_thickness=draw(st.floats(0.1, 0.4)),
        symmetry=draw(st.booleans()),
    )


def sides(problem):
    """Lengths of the elements along the interface and their middles, a pair an arm, from the control points alone."""
    meshes = [tspline_rectangle(mesh) for mesh in tmeshes(problem)] if problem.basis == "tspline" else ()
    for mesh, side in zip(meshes or drawn(problem).meshes, ("bottom", "top"), strict=False):
        face = surface(mesh, mesh.chains[side], 0)
        x = face.bezier_points(mesh.P_AI)[:, :, 0]
        yield x[:, -1] - x[:, 0], 0.5 * (x[:, 0] + x[:, -1])


def unknowns(problem) -> int:
    if problem.basis == "tspline":
        return sum(2 * len(mesh.anchors) for mesh in tmeshes(problem)[: 1 if problem.symmetry else 2])
    return sum(mesh.P_AI.size for mesh in drawn(problem).meshes)


@some
@given(problems())
def test_unknowns_are_those_aimed_at(problem):
    """One arm alone is one of two equal ones: half of what is aimed at, and half of what both gain at once."""
    aim = problem.dofs / (2 if problem.symmetry else 1)
    assert abs(unknowns(problem) - aim) <= max(0.02 * aim, missed(BASES[problem.basis]))


@pytest.mark.parametrize("basis", BASES)
@pytest.mark.parametrize("problem", [CZM1, CZM2], ids=["czm1", "czm2"])
@pytest.mark.parametrize("dofs", [280, 400, 1956, 4000, 10_000])
def test_the_specimens_of_the_paper_have_the_same_size_with_every_basis(basis, problem, dofs):
    assert unknowns(replace(problem, basis=basis, dofs=dofs)) == pytest.approx(dofs, rel=0.02)


def coarsest(problem, before: int, path: int, layers: float = 1.0) -> float:
    """One cubic element before the path may stand for two; few on the path ask for no more of them elsewhere, unless
    several layers halve them."""
    if path <= GRADING.few and layers < 1.5:
        return np.inf
    return coarsening(problem) * (2.0 if before == 1 and problem.degree >= 3 else 1.0)


def test_nearly_incompressible_arms_have_no_long_elements():
    """Poisson's ratio 0 has the longest; those of plane stress hardly matter."""
    strain = {
        nu: coarsening(replace(PAPER, plane="strain", nu12=nu, G12=E / (2 * (1 + nu))))
        for nu in (0.0, 0.3, 0.45, 0.4999)
    }
    assert strain[0.0] == GRADING.coarsening and strain[0.4999] == CRACK_PATH.coarsening
    assert strain[0.0] > strain[0.3] > strain[0.45] > strain[0.4999]
    assert (
        coarsening(replace(PAPER, plane="stress", nu12=0.4999, G12=E / (2 * (1 + 0.4999)))) > 0.9 * GRADING.coarsening
    )


@some
@given(problems(most=10_000))
def test_elements_are_equal_on_the_crack_path_and_longer_elsewhere(problem):
    """A boundary at the precrack; T-splines may have some elements at the end of the path that are not halved."""
    end = crack_path(problem)
    for length, middle in sides(problem):
        assert np.min(np.abs(middle - 0.5 * length - problem.precrack)) < 1e-12 * problem.length
        assert length.sum() == pytest.approx(problem.length, rel=1e-12)
        on_path = length[(middle > problem.precrack) & (middle < end)]
        shortest, longest = on_path.min(), on_path.max()
        if problem.basis == "tspline":
            assert np.log2(longest / shortest) == pytest.approx(round(np.log2(longest / shortest)), abs=1e-9)
            assert np.all(np.diff(on_path) > -1e-12)
        else:
            assert longest == pytest.approx(shortest, rel=1e-9)
        assert np.all(length >= 0.5 * shortest * (1.0 - 1e-9))
        if problem.basis != "tspline":
            allowed = coarsest(problem, np.sum(middle < problem.precrack), len(on_path)) * longest
            assert length.max() <= allowed * (1.0 + 1e-9)


def lines_on(mesh, j: int) -> np.ndarray:
    """Places of the lines of a T-mesh that have a function on the horizontal line j."""
    return np.unique(mesh.knots_i[mesh.anchors[mesh.anchors[:, 1] == j % len(mesh.knots_j), 0]])


@some
@given(problems(most=10_000).map(lambda problem: replace(problem, basis="tspline", symmetry=False)))
def test_t_splines_are_suitable_and_halve_their_elements_towards_the_interface(problem):
    """Elements opposite keep to the rule of all bases; at the interface those on the path are halved."""
    for mesh, top in zip(tmeshes(problem), (False, True), strict=True):
        assert mesh.suitable
        interface, opposite = (lines_on(mesh, j) for j in ((-3, 2) if top else (2, -3)))
        fine = np.diff(interface) < 1.5 * np.diff(interface).min()
        start, cell = interface[:-1][fine].min(), np.diff(opposite).min()
        assert (
            opposite[0] < start <= problem.precrack * (1.0 + 1e-12) and problem.precrack - start <= lead(problem) + cell
        )
        on_path = (opposite[:-1] >= start) & (opposite[1:] <= crack_path(problem) * (1.0 + 1e-12))
        cells = np.diff(opposite)
        before = np.sum(opposite[1:] <= start * (1.0 + 1e-12))
        bonded = np.sum(on_path & (opposite[1:] > problem.precrack * (1.0 + 1e-9)))
        layers = np.log2(cells[on_path].min() / np.diff(interface).min())
        assert cells.max() <= coarsest(problem, before, bonded, layers) * cells[on_path].max() * (1.0 + 1e-9)
        assert layers > 0.5 and layers == pytest.approx(round(layers), abs=1e-9)
        assert np.any(np.abs(opposite - problem.precrack) <= 1e-9 * problem.length)
        assert interface[1:][fine].max() <= crack_path(problem) * (1.0 + 1e-12)


@pytest.mark.parametrize(("dofs", "mismatch"), [(1956, 1.0), (6000, 1.0), (8000, 3.0)])
def test_layers_of_a_short_path_leave_unknowns_for_the_elements_beyond_it(dofs, mismatch):
    """Soft arms on a weak bond: a path of one thickness or two, in a specimen of seventy."""
    short = replace(
        CZM1, E1=200.0, E2=200.0, G12=100.0, nu12=0.0, strength=0.5, dofs=dofs, mismatch=mismatch, basis="tspline"
    )
    for mesh, j in zip(tmeshes(short), (-3, 2), strict=True):
        cells = np.diff(lines_on(mesh, j))
        assert cells.max() <= coarsening(short) * cells.min() * (1.0 + 1e-9)


@pytest.mark.parametrize("mismatch", [0.5, 0.73, 1.37, 3.0])
@pytest.mark.parametrize("basis", BASES)
def test_lengths_on_the_path_are_in_the_ratio_asked_for(basis, mismatch):
    problem = replace(CZM1, basis=basis, dofs=3000, mismatch=mismatch)
    shortest = [length[(m > 4.0) & (m < crack_path(problem))].min() for length, m in sides(problem)]
    assert shortest[1] / shortest[0] == pytest.approx(mismatch, rel=0.05)


STRAIN = replace(CZM1, plane="strain", nu12=0.45, G12=E / (2 * (1 + 0.45)))
RUNS = [(CZM1, "finite"), (CZM2, "linear"), (replace(CZM1, opening=(1.0,)), "finite"), (STRAIN, "linear")]


@pytest.mark.parametrize(("problem", "kinematics"), RUNS, ids=["czm1", "czm2", "a third", "plane strain"])
def test_the_crack_path_is_as_long_as_the_damage_goes_and_not_much_longer(problem, kinematics):
    last = solve(replace(problem, basis="tspline", dofs=400, steps=12, kinematics=kinematics)).rows[-1]
    ahead = crack_path(problem) - last["damage_front"]
    print(f"damage ends {ahead:.2f} before the path, crack {last['crack_length']:.2f}, zone {zone_length(problem):.2f}")
    assert 0.0 <= ahead < 1.5 * zone_length(problem)


def test_the_path_ends_with_the_bond_and_begins_with_the_precrack():
    assert crack_path(replace(CZM1, opening=(50.0,))) == 14.0
    closed = crack_path(replace(CZM1, opening=(-0.1,)))
    assert 4.0 < closed < 4.0 + zone_length(CZM1)
    assert crack_path(replace(CZM1, opening=(1.0, 3.0, 0.5))) == crack_path(CZM1)


def test_the_crack_at_the_end_of_the_path_releases_the_toughness():
    """Energy release rate P^2 / 2 dC/da of two slender arms, the compliance by differences; no zone worth the name."""
    opening, da = 3.0, 1e-5
    problem = replace(CZM1, opening=(opening,), strength=1e9, contact=False)
    a = np.sqrt(crack_path(problem) ** 2 - (0.5 * opening) ** 2)

    def compliance(a: float) -> float:
        return 2.0 * a**3 / (3.0 * E * problem.arm_thickness**3 / 12.0)

    load = opening / compliance(a)
    released = 0.5 * load**2 * (compliance(a + da) - compliance(a - da)) / (2.0 * da)
    assert released == pytest.approx(problem.toughness, rel=1e-3)


def test_arms_in_plane_strain_are_those_of_the_modulus_of_the_plane():
    """Path and zone as with E / (1 - nu^2) in plane stress: the crack of stiffer arms runs farther."""
    stiffer = replace(CZM1, E1=E / (1.0 - 0.45**2))
    assert crack_path(STRAIN) == pytest.approx(crack_path(stiffer), rel=1e-12)
    assert zone_length(STRAIN) == pytest.approx(zone_length(stiffer), rel=1e-12)


@pytest.mark.parametrize("penalty", [1.0, 10.0])
def test_the_path_goes_on_as_far_as_soft_contact_gives_way(penalty):
    """The decay of a beam on springs, EI d4w/dx4 + penalty w = 0, by the roots of its polynomial."""
    soft = replace(CZM1, opening=(1e-9,), penalty=penalty)
    roots = np.roots([E * soft.arm_thickness**3 / 12.0, 0.0, 0.0, 0.0, penalty])
    decay = 1.0 / np.abs(roots.real).min()
    assert decay > zone_length(CZM1)
    assert crack_path(soft) - soft.precrack == pytest.approx(decay, rel=1e-12)
    assert crack_path(replace(soft, contact=False)) == crack_path(replace(CZM1, opening=(1e-9,), contact=False))
    assert crack_path(replace(soft, penalty=1e9)) == crack_path(replace(soft, contact=False))


def test_the_process_zone_knows_no_units_and_goes_as_the_powers_of_the_theory():
    zone = zone_length(PAPER)
    in_metres = replace(PAPER, E1=1e6 * E, strength=4e6, toughness=1e3 * PAPER.toughness, arm_thickness=0.2e-3)
    assert zone_length(in_metres) == pytest.approx(1e-3 * zone, rel=1e-12)
    assert zone_length(replace(PAPER, strength=4.0 * PAPER.strength)) == pytest.approx(0.5 * zone)
    assert zone_length(replace(PAPER, toughness=16.0 * PAPER.toughness)) == pytest.approx(2.0 * zone)
    assert zone_length(replace(PAPER, arm_thickness=16.0 * 0.2)) == pytest.approx(8.0 * zone)
    assert zone_length(replace(PAPER, E1=81.0 * E)) == pytest.approx(3.0 * zone)


@pytest.mark.parametrize("interface_rule", ["gauss", "lumped"])
def test_equal_elements_on_the_path_where_points_must_meet(interface_rule):
    """Lumping needs them; otherwise an arm may have one element more where that meets the unknowns better."""
    meshes = [drawn(replace(CZM1, dofs=dofs, interface_rule=interface_rule)).meshes for dofs in range(240, 420, 8)]
    unequal = [
        not all(np.isclose(x, lower.P_AI[:, 0], atol=1e-9).any() for x in upper.P_AI[upper.P_AI[:, 0] > 5.5, 0])
        for upper, lower in meshes
    ]
    assert any(unequal) == (interface_rule == "gauss")
    assert max(abs(upper.elements - lower.elements) for upper, lower in meshes) <= 4


def made(problem, dofs):
    """Seconds of work for the meshes of a problem with so many unknowns, and how many they have."""
    start = process_time()
    if problem is PEEL:
        meshes = [tspline_rectangle(mesh) for mesh in peel_tmeshes(replace(PEEL, basis="tspline", dofs=dofs))]
    else:
        meshes = drawn(replace(problem, basis="tspline", dofs=dofs)).meshes
    return process_time() - start, sum(mesh.P_AI.size for mesh in meshes)


@pytest.mark.slow  # a rate of seconds is worth something on a quiet machine only
@pytest.mark.parametrize("problem", [CZM1, PEEL], ids=["arms", "peel"])
def test_meshes_of_fifty_thousand_unknowns_take_seconds_and_grow_with_their_size(problem):
    sizes = (6_250, 12_500, 25_000, 50_000)
    turns = np.array([[made(problem, dofs) for dofs in sizes] for _ in range(7)])  # a slow spell meets every size
    seconds, found = turns.min(axis=0).T
    exponent = np.polyfit(np.log(found), np.log(seconds), 1)[0]
    print(f"seconds {seconds.round(2)}, exponent {exponent:.2f}")
    assert np.all(np.abs(found / sizes - 1.0) < 0.02)
    assert seconds[-1] < 10.0 and exponent < 1.2


def test_what_no_mesh_can_be_made_of_is_refused():
    with pytest.raises(ValueError, match="degree must be 3 for T-splines, got 2"):
        drawn(replace(CZM1, basis="tspline", degree=2))
    with pytest.raises(ValueError, match="degree must be 3 for T-splines, got 4"):
        peel_tmeshes(replace(PEEL, basis="tspline", degree=4))
    for basis in BASES:
        with pytest.raises(ValueError, match="needs at least [0-9]+ unknowns, got 60"):
            drawn(replace(CZM1, basis=basis, dofs=60))
    with pytest.raises(ValueError, match="needs at least"):
        build(replace(CZM1, basis="tspline", dofs=60))


def test_where_few_elements_are_on_the_path_there_are_no_more_elsewhere():
    """Up to seven; from eight on as many as their length asks for."""
    late = replace(PAPER, precrack=10.0, opening=(0.5,))
    (before, _, beyond), _ = division(late, 7)
    assert (before, beyond) == (7, 7)
    (before, _, beyond), places = division(late, 8)
    assert before > 8 and beyond > 8 and places[0] == 0.0 and places[-1] == late.length


@pytest.mark.parametrize("basis", [name for name, basis in BASES.items() if not basis.local])
def test_layers_divide_the_arms_through_their_thickness(basis):
    """More of them make short stocky arms softer: one cubic element does not follow how a section warps in shear."""
    stocky = replace(
        CZM1, basis=basis, precrack=1.0, arm_thickness=1.0, dofs=4000, opening=(1e-4,), kinematics="linear"
    )
    meshes = drawn(replace(stocky, layers=3)).meshes
    assert all(np.unique(mesh.P_AI[:, 1]).size == BASES[basis].columns(3, 3) for mesh in meshes)
    assert 2 * sum(len(mesh.P_AI) for mesh in meshes) == pytest.approx(4000, rel=0.02)
    loads = [solve(replace(stocky, layers=n)).load[-1] for n in (1, 2, 3)]
    assert loads[0] > loads[1] > loads[2] > 0.99 * loads[0]


def test_a_base_has_layers_of_its_own():
    with pytest.raises(ValueError, match="layers: must be 1 on a base"):
        drawn(replace(PEEL, layers=2))
