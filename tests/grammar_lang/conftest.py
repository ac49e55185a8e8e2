from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from grammar_lang.diagnostics.diagnostic import Severity
from grammar_lang.load import Loaded, load_text

ROOT = Path(__file__).parents[2]

PARTS = {
    "modules": """
module B  { role base; }
module JO { role joint; dof q: revolute z in [-180, 180] deg; }
module L  { role link; param length in [0.5, 5] m; const density = 1 kg/m; }
module EN { role effector; }
edge eps;
""",
    "grammar": """
grammar G {
  start N;
  base:  N -> B;
  joint: N -> N eps JO;
  link:  N -> N eps L;
  tool:  N -> N eps EN;
}
""",
    "semantics": """
semantics G {
  base  { this.frame = world; }
  joint { this.frame = N.frame * rot(z, JO.q); }
  link  { this.frame = N.frame * move(x, L.length); }
  tool  { this.frame = N.frame; effector(frame: N.frame); }
}
""",
    "workspace": """
workspace W {
  plane xy;
  bounds box [0, 5] x [0, 5] m;
  region S box [0, 1] x [0, 1] m;
  target T box [3, 4] x [3, 4] m;
}
""",
    "task": """
task P {
  robot G; workspace W;
  start in S; reach T;
  effort <= 10 N*m;
  horizon 80 steps of 0.125 s;
}
""",
}


def findings(loaded: Loaded) -> list[tuple[str, str]]:
    """Code and marked text of each diagnostic."""
    text = loaded.sources[0].text
    return [(d.code.name, text[d.span.start : d.span.end]) for d in loaded.diagnostics]


@pytest.fixture(scope="session")
def arm() -> str:
    """The running example."""
    return (ROOT / "specs" / "planar_arm.srg").read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def build() -> Callable[..., str]:
    """A small specification with some parts replaced."""

    def make(**parts: str) -> str:
        assert parts.keys() <= PARTS.keys()
        return "".join(parts.get(name, text) for name, text in PARTS.items())

    return make


@pytest.fixture(scope="session")
def check() -> Callable[[str], list[tuple[str, str]]]:
    """Load a text; the code and the marked text of every diagnostic."""

    def run(text: str) -> list[tuple[str, str]]:
        loaded = load_text(text, "t.srg")
        failed = any(d.severity is Severity.ERROR for d in loaded.diagnostics)
        assert (loaded.program is None) == failed
        assert all(d.hint for d in loaded.diagnostics)
        return findings(loaded)

    return run


@pytest.fixture(scope="session")
def check_fragment(
    check: Callable[[str], list[tuple[str, str]]],
) -> Callable[[str], list[tuple[str, str]]]:
    """As ``check``, for a part of a file that leaves names unused."""
    return lambda text: [found for found in check(text) if found[0] != "UNUSED_NAME"]
