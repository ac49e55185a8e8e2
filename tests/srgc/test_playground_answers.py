"""What the page of the playground is answered, without a browser."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from srgc.playground import spec
from srgc.playground.answers import answer
from tests.oracles.small_specs import TURNER

SPECS = Path(__file__).parents[2] / "specs"
ROBOT = "\N{ROBOT FACE}"
"""Two code units of UTF-16."""


def ask(**request: object) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(answer(json.dumps(request)))
    return found


@pytest.fixture
def no_solver(monkeypatch: pytest.MonkeyPatch) -> None:
    """As in a browser."""
    spec.spec_of.cache_clear()
    monkeypatch.setattr(spec, "has_solver", lambda: False)


def test_places_count_code_units() -> None:
    text = f"// {ROBOT}\n{TURNER.replace('reach T', 'reach Nowhere')}"
    found = ask(ask="check", text=text)["answer"]
    [(start, end)] = found["places"]
    units = text.encode("utf-16-le")
    assert units[2 * start : 2 * end].decode("utf-16-le") == "Nowhere"
    offered = ask(ask="complete", text=text, at=end)["answer"]
    assert offered["start"] == start
    assert {offer["label"] for offer in offered["offers"]} == {"T", "S", "O"}


def test_a_place_in_another_file_has_none() -> None:
    text = 'include std "serial.srg";\nmodule Drive { role base; }\n'
    found = ask(ask="check", text=text)["answer"]
    files = [each["file"] for each in found["findings"]]
    assert [place is not None for place in found["places"]] == [f == "spec.srg" for f in files]


@pytest.mark.usefixtures("no_solver")
def test_formulas_are_left_out_and_it_says_so() -> None:
    text = (SPECS / "patrol.srg").read_text(encoding="utf-8")
    found = ask(ask="check", text=text)["answer"]
    assert found["findings"] == []
    [said] = found["unchecked"]
    assert "formula of task `Patrol`" in said


def test_with_a_solver_nothing_is_left_out() -> None:
    spec.spec_of.cache_clear()
    text = (SPECS / "patrol.srg").read_text(encoding="utf-8")
    assert ask(ask="check", text=text)["answer"]["unchecked"] == []


def test_hover() -> None:
    at = TURNER.index("L.density") + 3
    found = ask(ask="hover", text=TURNER, at=at)["answer"]
    assert TURNER[found["start"] : found["end"]] == "density"
    assert "1 kg/m" in found["text"]
    assert ask(ask="hover", text=TURNER, at=TURNER.index("{"))["answer"] is None


@pytest.mark.parametrize(
    ("request_", "said"),
    [
        ({"ask": "fmt", "text": "module {"}, "SRG0104"),
        ({"ask": "explain", "text": "", "code": "999999"}, "there is no code"),
        ({"ask": "graph", "text": "module {", "of": "sra"}, "SRG0104"),
        ({"ask": "graph", "text": TURNER, "of": "words", "depth": 12}, "choose a --depth below"),
        ({"ask": "graph", "text": TURNER, "of": "robot"}, "needs the word"),
    ],
)
def test_faults_are_messages(request_: dict[str, object], said: str) -> None:
    whole = {"grammar": "", "word": "", "depth": 0} if request_["ask"] == "graph" else {}
    assert said in ask(**{**whole, **request_})["fault"]


def test_a_browser_needs_nothing_that_it_has_not() -> None:
    """All is answered where no native library can be imported, nor a process, thread or server."""
    program = """
import json, sys
for name in ("casadi", "clarabel", "flint", "numpy", "pygls", "pysat", "scipy", "yaml", "z3"):
    sys.modules[name] = None
from srgc.playground.answers import answer
text, flint = sys.stdin.read().split("\\0")
more = {"code": "301", "of": "sra", "grammar": "", "word": "", "depth": 0, "at": 10}
kept = {"check": (), "fmt": (), "explain": ["code"], "graph": ["of", "grammar", "word", "depth"],
        "complete": ["at"], "hover": ["at"]}
for ask, names in kept.items():
    asked = {"ask": ask, "text": text, **{name: more[name] for name in names}}
    found = json.loads(answer(json.dumps(asked)))
    assert "answer" in found, (ask, found)
assert json.loads(answer(json.dumps({"ask": "check", "text": flint}))) == {"needs": "flint"}
assert not {"asyncio", "socket", "multiprocessing"} & set(sys.modules), sys.modules
"""
    flint = (SPECS / "l_shaped.srg").read_text(encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-c", program],
        input=f"{TURNER}\0{flint}",
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
