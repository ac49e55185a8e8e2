"""Random formulas, and tasks to put them in."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from hypothesis import strategies as st

from grammar_lang import ir
from grammar_lang.load import load_text

FAMILY = """\
module B { role base; }
module J { role joint; dof q: revolute z in [-170, 170] deg; }
module L { role link; param length in [0.5, 2] m; }
module E { role effector; }
edge eps;
grammar Arm {
  start N;
  base: N -> B;  joint: N -> N eps J;  link: N -> N eps L;  tool: N -> N eps E;
  accept matches B (eps J eps L)+ eps E;
}
semantics Arm {
  base  { this.frame = world; }
  joint { this.frame = N.frame * rot(z, J.q); }
  link  { this.frame = N.frame * move(x, L.length);
          rod(frame: N.frame, axis: x, length: L.length, density: 1 kg/m); }
  tool  { this.frame = N.frame; effector(frame: N.frame); }
}
"""
ONE_ARM, TWO_ARMS = "(eps J eps L)+ eps E", "(eps J eps L)+ eps E (eps J eps L)* eps E"

SHAPES = {
    "disjoint": "region A box [0, 1] x [0, 1] m; region C box [2, 3] x [0, 1] m;",
    "touching": "region A box [0, 1] x [0, 1] m; region C box [1, 3] x [0, 1] m;",
    "overlapping": "region A box [0, 2] x [0, 1] m; region C box [1, 3] x [0, 1] m;",
    "nested": "region A box [0, 3] x [0, 1] m; region C box [1, 2] x [0.2, 0.8] m;",
}
KINDS = {
    "disjoint": ("", "A", "C"),
    "touching": ("", "A", "C", "AC"),
    "overlapping": ("", "A", "C", "AC"),
    "nested": ("", "A", "AC"),
}


def spec(
    clauses: str, regions: str, *, horizon: str = "8 steps of 0.5 s", arms: str = ONE_ARM
) -> str:
    """A file with one task, ``P``."""
    return f"""{FAMILY.replace(ONE_ARM, arms)}
workspace W {{ plane xy; bounds box [-1, 4] x [-1, 4] m; {regions} }}
task P {{
  robot Arm; workspace W; effort <= 1 N*m; horizon {horizon};
  {clauses}
}}
"""


def program(text: str) -> ir.Program:
    loaded = load_text(text, "spec.srg")
    assert loaded.program is not None, loaded.diagnostics
    return loaded.program


@st.composite
def windows(draw: st.DrawFn, seconds: int) -> ir.Window:
    lower = draw(st.integers(0, seconds + 1))
    upper = draw(st.none() | st.integers(lower, seconds + 2))
    return ir.Window(Fraction(lower), None if upper is None else Fraction(upper))


def without_window(f: st.SearchStrategy[ir.Formula]) -> list[st.SearchStrategy[ir.Formula]]:
    """What operators make of formulas, but for those that take a time."""
    return [
        st.builds(ir.Not, f),
        st.builds(lambda a, b: ir.And((a, b)), f, f),
        st.builds(lambda a, b: ir.Or((a, b)), f, f),
        st.builds(ir.Implies, f, f),
        st.builds(ir.Until, f, f),
        st.builds(ir.Next, f),
    ]


def formulas(
    seconds: int, effectors: int, *, deep: int, poses: Sequence[tuple[ir.Pose, ...]] = ((),)
) -> st.SearchStrategy[ir.Formula]:
    """Formulas over A and C, in some poses, with times in whole seconds."""
    atoms: st.SearchStrategy[ir.Formula] = st.builds(
        ir.Atom, st.sampled_from("AC"), st.integers(1, effectors), poses=st.sampled_from(poses)
    )

    def grown(f: st.SearchStrategy[ir.Formula]) -> st.SearchStrategy[ir.Formula]:
        return st.one_of(
            *without_window(f),
            st.builds(ir.Always, f, windows(seconds)),
            st.builds(ir.Eventually, f, windows(seconds)),
            st.builds(ir.Last, st.integers(0, seconds + 1).map(Fraction), f),
        )

    return st.recursive(atoms, grown, max_leaves=deep)
