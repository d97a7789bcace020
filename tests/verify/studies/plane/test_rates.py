"""Rates of the bases: optimal where theory says so, 2.5 at extraordinary points, and both on the page."""

import pytest

from verify import report
from verify.studies.plane.errors import Errors
from verify.studies.plane.rates import MESH_FAMILIES, Convergence, half_fine, rate_checks, rates


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
    report.write(report.Findings((), {}, rates=found), tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text()
    assert all(family.name in text for family in MESH_FAMILIES)
    assert "around extraordinary points 2." in text and 'id="rates-errors-t"' in text


def made_up(number: int, rate: float) -> Convergence:
    """A family whose error falls by that rate, 1e-3 on the first mesh, and by one less in energy."""
    at = [Errors(1e-3 / 2 ** (rate * i), 2e-2 / 2 ** ((rate - 1.0) * i), 1.0) for i in range(3)]
    return Convergence(MESH_FAMILIES[number], (100, 400, 1600), tuple(at))


def test_a_check_is_how_far_a_rate_is_from_that_of_theory() -> None:
    checks = rate_checks((made_up(0, 4.1), made_up(1, 3.8), made_up(2, 2.4)))
    assert [check.subject for check in checks] == [family.name for family in MESH_FAMILIES[:2]]
    assert [check.value for check in checks] == pytest.approx([0.1, -0.2])
    assert [check.passed for check in checks] == [True, False]
    assert [rate_checks((made_up(0, 4.0 + off),))[0].passed for off in (0.149, 0.151)] == [True, False]


def test_the_section_tells_errors_and_rates_of_every_family(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    import numpy as np
    from figures import Drawn

    from verify.pages.style import colour
    from verify.report.studies import plane_rates

    drawn, known = (
        Drawn(monkeypatch, plane_rates),
        (made_up(0, 4.0), made_up(1, 3.5), made_up(2, 2.5), made_up(3, 2.25)),
    )
    found = plane_rates.section(known, "rates")
    assert found.counts.broken == 1 and len(found.checks) == 2 and found.panel.svg == "<svg>rates-errors</svg>"
    assert found.sentence == (
        "Rates in L2 of cubic bases in plane elasticity: NURBS 4.00, T-spline with T-junctions 3.50, "
        "around extraordinary points 2.25 to 2.50."
    )
    only = plane_rates.section(known[:1], "rates")
    assert only.sentence.endswith("elasticity: NURBS 4.00.") and only.counts.broken == 0
    _, names, cells = zip(*found.rows, strict=True)
    assert list(names) == [family.name for family in MESH_FAMILIES[:4]]
    assert cells[0][0] == "1600" and cells[0][2:4] == ("4.00", "4") and cells[0][5] == "3.00"
    assert cells[2][2:4] == ("2.50", "–") and cells[2][5] == "1.50"
    assert cells[2][1] == "3.12\u00a0×\u00a010⁻⁵" and cells[2][4] == "0.0025"
    axes = drawn[0][1].axes[0]
    for line, one in zip(axes.lines, known, strict=True):
        assert line.get_color() == colour(one.family.ink) and line.get_marker() == "o"
        assert line.get_xdata() == pytest.approx(np.sqrt(one.unknowns))
        assert line.get_ydata() == pytest.approx([e.displacement for e in one.errors])
    assert axes.get_xscale() == axes.get_yscale() == "log"
    assert not [*axes.xaxis.get_minorticklocs(), *axes.yaxis.get_minorticklocs()], "every tick has its number"
    assert "relative error" in axes.get_ylabel() and "unknowns" in axes.get_xlabel()
