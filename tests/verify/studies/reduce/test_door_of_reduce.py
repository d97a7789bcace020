"""Whatever is in a file, `debond reduce` answers with a table or with a sentence."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from made_up_tests import Rig, recorded, text_of
from odd_inputs import CURVES, QUIET, answered

PLAIN = text_of(recorded("dcb", Rig(rows=60, readings=6)))
NUMBERS = st.sampled_from(["0", "-1", "1e-300", "1e300", "nan", "", "x", "3.2", "35", "60"])

FEW = settings(max_examples=16, suppress_health_check=QUIET)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@given(text=CURVES)
@FEW
@pytest.mark.filterwarnings("error")
def test_odd_files(text, folder, capsys):
    Path("a.csv").write_bytes(text)
    code, said = answered(capsys, "reduce", "a.csv", "--scene", "dcb-as4peek")
    assert code == 0 or said.startswith("debond: a.csv"), said


@given(cells=st.lists(st.tuples(st.integers(0, 59), st.integers(0, 2), NUMBERS), max_size=6), data=st.data())
@FEW
@pytest.mark.filterwarnings("error")
def test_a_test_with_odd_cells(cells, data, folder, capsys):
    header, *rows = PLAIN.splitlines()
    table = [row.split(",") for row in rows]
    for row, column, text in cells:
        table[row][column] = text
    Path("a.csv").write_text("\n".join([header, *(",".join(row) for row in table)]))
    scene = data.draw(
        st.sampled_from(["dcb-as4peek", "enf-as4peek", "slb", "4enf", "mmb50-as4peek", "adcb-czmtestkit-a"])
    )
    words = data.draw(st.sampled_from([[], ["--crack", "a"], ["--no-toe"], ["--machine-compliance", "1e-3"]]))
    code, said = answered(capsys, "reduce", "a.csv", "--scene", scene, *words)
    assert code == 0 or said.startswith(("debond: a.csv", "debond: --machine")), said
