"""Rates of the bases: optimal where theory says so, 2.5 at extraordinary points, and both on the page."""

import pytest

from verify import report
from verify.plane_rates import FAMILIES, half_fine, rate_checks, rates


@pytest.fixture(scope="module")
def found():
    return rates(counts=(8, 16))


def test_smooth_bases_are_optimal_and_extraordinary_points_are_not(found):
    assert [c.family.order for c in found] == [4, 4, None, None, None]
    for c in found:
        expected = 2.5 if c.family.order is None else 4.0
        assert c.rates == pytest.approx((expected, expected - 1.0), abs=0.1), c.family.name
    assert [check.passed for check in rate_checks(found)] == [True, True]


def test_the_t_spline_has_junctions():
    mesh = half_fine(8)
    assert 8 * 8 < mesh.elements < 16 * 8, "between the coarse and the fine grid"
    assert 11 * 11 < len(mesh.P_AI) < 19 * 11


def test_they_are_on_the_page(found, tmp_path):
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    report.write((), tmp_path / "report.html", {}, rates=found)
    text = (tmp_path / "report.html").read_text()
    assert all(family.name in text for family in FAMILIES)
    assert "around extraordinary points 2." in text and 'id="rates-errors-t"' in text
