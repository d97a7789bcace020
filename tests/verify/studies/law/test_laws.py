"""Laws as functions: how they are called, and the sentences for what they must not do."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from verify.studies.law.laws import function, of_function
from verify.studies.law.paths import JumpPath
from verify.support.refusal import Refusal

WAY = JumpPath("short", "", np.array([0.0, 1.0, 2.0]), np.array([0.0, 0.0, 1.0]))


def test_a_law_is_called_step_by_step_with_its_own_state():
    seen = []

    def law(g: float, s: float, state: list | None, dt: float) -> tuple:
        seen.append((type(g), type(s), state, dt))
        return 2.0 * g, 3.0 * s, [*(state or []), g]

    found = of_function(law, WAY)
    assert found.p.tolist() == [0.0, 2.0, 4.0] and found.t.tolist() == [0.0, 0.0, 3.0] and found.tangent is None
    assert seen == [(float, float, None, 0.5), (float, float, [0.0], 0.5), (float, float, [0.0, 1.0], 0.5)]


def test_differences_leave_the_state_as_it_was():
    """A law may change its state in place."""

    def law(g: float, s: float, state: dict | None, dt: float) -> tuple:
        state = state or {"steps": 0}
        state["steps"] += 1
        return g * state["steps"], s, state, ((state["steps"], 0.0), (0.0, 1.0))

    found = of_function(law, WAY)
    assert found.p.tolist() == [0.0, 2.0, 6.0]
    assert found.differences is not None
    assert found.differences[1:, ..., 0, 0] == pytest.approx(np.tile([[[2.0]], [[3.0]]], (1, 5, 2)), rel=1e-6)


def raises(g: float, s: float, state: object, dt: float) -> tuple:
    raise KeyError("no such thing")


def leaves(g: float, s: float, state: object, dt: float) -> tuple:
    raise SystemExit(3)


def late(g: float, s: float, state: object, dt: float) -> tuple:
    return (g, s, None, np.eye(2)) if g < 1.5 else (g, s, None)


WRONG: dict[str, tuple[Callable, str]] = {
    "raises": (raises, "in raises: KeyError: 'no such thing'"),
    "exit": (leaves, "SystemExit: 3"),
    "nothing": (lambda *a: None, "must return p, t, state or p, t, state, tangent, got None"),
    "two": (lambda g, s, *a: (g, s), "must return p, t, state"),
    "nan": (lambda g, s, *a: (np.nan, s, None), "p must be a finite number, got nan"),
    "words": (lambda g, s, *a: (g, "much", None), "t must be a finite number, got 'much'"),
    "flat tangent": (lambda g, s, *a: (g, s, None, [1, 0, 0, 1]), "the tangent must be 2 x 2 finite numbers"),
    "tangent now and then": (late, "must return a tangent at every step or at none"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_no_law_is_refused_with_a_sentence(name):
    law, said = WRONG[name]
    with pytest.raises(Refusal) as refused:
        of_function(law, WAY, "my_law")
    assert said in str(refused.value) and "\n" not in str(refused.value) and str(refused.value).startswith("my_law:")


def test_the_line_of_the_user_is_named():
    with pytest.raises(Refusal, match=r"test_laws\.py:\d+, in raises: KeyError: 'no such thing'"):
        of_function(raises, WAY)


def test_functions_are_found_in_files_and_modules(tmp_path, monkeypatch):
    (tmp_path / "beside.py").write_text("K = 2.0\n")
    (tmp_path / "my_own_law.py").write_text(
        "from beside import K\n\ndef law(g, s, state, dt):\n    return K * g, s, 0\n"
    )
    monkeypatch.chdir(tmp_path)
    for text in ("my_own_law:law", "my_own_law.py:law", f"{tmp_path}/my_own_law.py:law"):
        law = function(text)
        assert law is not None and of_function(law, WAY).p.tolist() == [0.0, 2.0, 4.0]
    assert {function(text) for text in ("tractions.csv", "a:b.csv", ":law")} == {None}


BROKEN = {
    "nowhere:law": "nowhere cannot be imported: ModuleNotFoundError",
    "nowhere.py:law": "got no file nowhere.py",
    "wrong.py:law": "cannot be imported: SyntaxError",
    "fails.py:law": "fails.py:2, in <module>: ZeroDivisionError",
    "empty.py:law": "empty.py must have a function law, got nothing",
    "number.py:law": "number.py must have a function law, got int",
}


@pytest.mark.parametrize("text", BROKEN)
def test_a_function_that_is_not_there_is_refused(text, tmp_path, monkeypatch):
    sources = {"wrong": "def law(:\n", "fails": "\nx = 1 / 0\n", "empty": "", "number": "law = 3\n"}
    for name, source in sources.items():
        (tmp_path / f"{name}.py").write_text(source)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(Refusal) as refused:
        function(text)
    assert BROKEN[text] in str(refused.value) and "\n" not in str(refused.value)
