"""The law of a scene for opening and sliding: its numbers, in any units, and none where nothing slides."""

import numpy as np
import pytest

from verify.scene.bond.mixed import mixed_bond
from verify.scene.load import load_scene
from verify.scene.parse import SceneError
from verify.studies.hard.invariance import in_units

SHEAR = ("interface.shear_strength=5.0", "interface.shear_toughness=0.2")


def test_a_bond_that_opens_alone_is_none():
    assert mixed_bond(load_scene("dcb-czm1")) is None and mixed_bond(load_scene("peel-60")) is None


def test_it_has_the_numbers_of_the_scene():
    """Those of AS4/PEEK in Camanho, Davila, de Moura (2003)."""
    bond = mixed_bond(load_scene("dcb-as4peek"))
    assert (bond.strength, bond.toughness, bond.stiffness) == ((80.0, 100.0), (0.969, 1.719), (1e5, 1e5))
    assert (bond.law, bond.criterion, bond.exponent, bond.onset) == ("bilinear", "bk", 2.284, "turon")
    assert (bond.penalty, bond.contact, bond.irreversible) == (1e5, True, True)
    assert bond.critical(np.array([0.0, 0.5, 1.0])) == pytest.approx([0.969, 0.969 + 0.75 * 0.5**2.284, 1.719])


def test_every_key_reaches_it():
    more = ("criterion=power", "exponent=1.5", "friction=0.3", "viscosity=0.01", "pressure_strength=0.4")
    keys = [*SHEAR, *(f"interface.{key}" for key in more), "effects.contact=false", "effects.irreversible=false"]
    bond = mixed_bond(load_scene("dcb-czm1", keys))
    assert (bond.criterion, bond.exponent, bond.onset) == ("power", 1.5, "quadratic")
    assert (bond.friction, bond.viscosity, bond.pressure_strength) == (0.3, 0.01, 0.4)
    assert not bond.contact and not bond.irreversible
    flat = mixed_bond(load_scene("dcb-czm1", [*SHEAR, "interface.law=trapezoidal", "interface.plateau=0.2"]))
    assert (flat.law, flat.plateau) == ("trapezoidal", 0.2)


@pytest.mark.parametrize("keys", [(), ("criterion=power", "shear_stiffness=600.0"), ("viscosity=0.1", "friction=0.3")])
def test_a_scene_in_metres_and_pascals_has_the_same_bond(keys):
    scene = load_scene("dcb-czm1", [*SHEAR, *(f"interface.{key}" for key in keys)])
    here, there = (mixed_bond(one) for one in (scene, in_units(scene, 1.0, 1e-3, "N, m, Pa")))
    assert there.strength == pytest.approx(1e6 * np.array(here.strength), rel=1e-13)
    assert there.stiffness == pytest.approx(1e9 * np.array(here.stiffness), rel=1e-13)
    g, s = np.array([[-1e-4, 2e-3, 1e-2, 2e-2, 8e-2], [1e-2, 0.0, 5e-3, 3e-2, 4e-2]])
    one, other = here.path(g, s), there.path(1e-3 * g, 1e-3 * s)
    scale = {"p": 1e6, "t": 1e6, "d": 1.0, "released": 1e3, "stored": 1e3}
    for name, factor in scale.items():
        assert getattr(other, name) == pytest.approx(factor * getattr(one, name), rel=1e-9, abs=1e-12 * factor), name
    assert one.d[-1] > 0.5


def test_a_toughness_that_is_used_up_before_damage_is_refused_with_the_mode_ratio():
    """The toughness of BK with a large exponent stays low up to pure sliding; the onset of the stresses does not."""
    keys = ("onset=quadratic", "exponent=20.0", "shear_toughness=4.0", "ductility=3.0")
    B = np.linspace(0.0, 1.0, 1001)
    worst = B[np.argmax(1.0 / ((1.0 - B) / 0.1 + B / 4.0) / (0.1 + 3.9 * B**20))]  # 0.76
    with pytest.raises(SceneError, match=rf"interface\.stiffness: must store less .* at the mode ratio {worst:g}"):
        load_scene("dcb-czm1", [*SHEAR, *(f"interface.{key}" for key in keys)])
