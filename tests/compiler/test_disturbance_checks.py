"""Radii against the ranges of joints, and joints that nothing drives."""

from __future__ import annotations

import pytest

from compiler.checks.disturbance_checks import disturbance_diagnostics
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.load import load_text

SPEC = """
module B { role base; }
module J { role joint; dof q: revolute z in [-90, 90] deg rate in [-1, 2] rad/s; }
module Wrist { role joint; dof q: revolute z in [-1, 1] deg; }
module S { role joint; dof s: prismatic x in [0, 40] mm; TORQUE }
module F { role joint; dof q: revolute z; }
grammar G { start N; b: N -> B; j: N -> N J; s: N -> N S; OTHERS }
semantics G {
  b { this.f = world; } j { this.f = N.f * rot(z, J.q); point(frame: this.f, mass: 1 kg); }
  s { this.f = N.f * move(x, S.s); effector(frame: this.f); } BLOCKS
}
workspace W { plane xy; bounds box [-1, 1] x [-1, 1] m; region R box [0, 1] x [0, 1] m; }
task P {
  robot G; workspace W; start in R; reach R; EFFORT horizon 1 steps of 1 s; CLAUSES
}
"""
WRIST = "w: N -> N Wrist;", "w { this.f = N.f * rot(z, Wrist.q); }"
FREE = "w: N -> N F;", "w { this.f = N.f * rot(z, F.q); }"
NONE = "", ""


def found(clauses: str, others: tuple[str, str] = NONE, torque: str = "") -> list[tuple[str, ...]]:
    """Severity and code of what is found, and what the place and the note mark."""
    text = SPEC.replace("CLAUSES", clauses).replace("TORQUE", torque)
    text = text.replace("OTHERS", others[0]).replace("BLOCKS", others[1])
    driven = not torque or "u" in torque.split("=")[1]
    text = text.replace("EFFORT", "effort <= 1 N*m;" + " effort <= 1 N;" * driven)
    loaded = load_text(text, "spec.srg")
    assert loaded.program is not None, loaded.diagnostics
    sink = Sink()
    disturbance_diagnostics(loaded.program, sink)
    marked = []
    for each in sink.found:
        assert each.hint
        assert len(each.notes) == 1
        spans = (each.span, each.notes[0][0])
        texts = (text[span.start : span.end].split(":")[0] for span in spans)
        marked.append((each.severity.value, each.code.value, *texts))
    return marked


@pytest.mark.parametrize(
    ("clauses", "others", "expected"),
    [
        ("robust start 89 deg, 19 mm, 1.4 rad/s, 100 m/s;", NONE, []),
        ("robust start 90 deg;", NONE, [("error", "90 deg", "dof q")]),
        ("robust start 20 mm;", NONE, [("error", "20 mm", "dof s")]),
        ("robust start 5 deg, 1.5 rad/s;", NONE, [("error", "1.5 rad/s", "dof q")]),
        ("robust start 95 deg, 30 mm;", NONE,
         [("error", "95 deg", "dof q"), ("error", "30 mm", "dof s")]),
        ("robust measure 179 deg, 39 mm, 2.9 rad/s;", NONE, []),
        ("robust measure 180 deg;", NONE, [("error", "180 deg", "dof q")]),
        ("robust measure 40 mm;", NONE, [("error", "40 mm", "dof s")]),
        # Other joints of the kind are wide enough.
        ("robust start 1 deg;", WRIST, [("warning", "1 deg", "dof q")]),
        ("robust start 0.99 deg;", WRIST, []),
        ("robust start 91 deg;", WRIST, [("error", "91 deg", "dof q")]),
        ("robust start 91 deg;", FREE, [("warning", "91 deg", "dof q")]),
        ("control feedback;", WRIST, []),
    ],
)  # fmt: skip
def test_radii(clauses: str, others: tuple[str, str], expected: list[tuple[str, ...]]) -> None:
    assert [(a, c, d) for a, b, c, d in found(clauses, others) if b == "SRG0716"] == expected
    assert all(item[1] == "SRG0716" for item in found(clauses, others))


@pytest.mark.parametrize(
    ("clauses", "marked", "hint"),
    [
        ("robust start 1 mm, 1 deg, 1 mm/s;", ["1 mm", "1 mm/s"], "write an angle"),
        ("robust measure 1 mm/s;", ["1 mm/s"], "write an angular rate"),
        ("robust start 1 deg, 1 deg/s; robust measure 1 deg;", [], ""),
    ],
)
def test_radii_of_joints_that_no_robot_has(clauses: str, marked: list[str], hint: str) -> None:
    text = SPEC.replace("CLAUSES", clauses).replace("TORQUE", "")
    text = text.replace("OTHERS", "").replace("BLOCKS", "").replace("EFFORT", "effort <= 1 N*m;")
    text = text.replace("s: N -> N S;", "s: N -> N E;").replace(" * move(x, S.s)", "")
    loaded = load_text("module E { role effector; }" + text, "spec.srg")
    assert loaded.program is not None, loaded.diagnostics
    sink = Sink()
    disturbance_diagnostics(loaded.program, sink)
    found = [("module E { role effector; }" + text)[d.span.start : d.span.end] for d in sink.found]
    assert found == marked
    assert {(d.severity.value, d.code.value) for d in sink.found} <= {("warning", "SRG0703")}
    if marked:
        assert sink.found[0].message == "no robot of `G` has a prismatic joint: this has no effect"
        assert (sink.found[0].hint or "").startswith(hint)
    sink = Sink()
    disturbance_diagnostics(loaded.program, sink, complete=False)
    assert sink.found == []


MOTOR = (
    "state i A; input v in [-1, 1] V; der(i) = (v - 1 V/A * i) / (1 V*s/A); torque(s) = 1 N/A * i;"
)


@pytest.mark.parametrize(
    ("torque", "driven"),
    [
        ("torque(s) = u - 1 N*s/m * rate(s);", True),
        ("torque(s) = -1 N*s/m * rate(s);", False),
        ("torque(s) = 2 N/m * s;", False),
        (MOTOR, True),
        (MOTOR.replace("(v - 1 V/A * i)", "(1 V*s/m * rate(s) - 1 V/A * i)"), False),
    ],
)
@pytest.mark.parametrize(
    ("clauses", "asked"),
    [("control feedback;", True), ("robust measure 1 mm;", True), ("control open loop;", False),
     ("robust start 1 mm;", False), ("", False)],
)  # fmt: skip
def test_joints_without_an_input(torque: str, driven: bool, clauses: str, asked: bool) -> None:
    expected = [] if driven or not asked else ["SRG0717"]
    assert [item[1] for item in found(clauses, torque=torque)] == expected


def test_what_may_correct_a_joint_without_an_input() -> None:
    torque = "torque(s) = -1 N*s/m * rate(s);"
    hints = []
    for spec in (SPEC, SPEC.replace("j: N -> N J;", "").replace("j { this.f = N.f * rot(z, J.q); "
                 "point(frame: this.f, mass: 1 kg); }", "")):  # fmt: skip
        text = spec.replace("CLAUSES", "control feedback;").replace("TORQUE", torque)
        text = text.replace("OTHERS", "").replace("BLOCKS", "").replace("EFFORT", "")
        text = text.replace("horizon", "effort <= 1 N*m; horizon" if "rot(" in text else "horizon")
        loaded = load_text(text, "spec.srg")
        assert loaded.program is not None, loaded.diagnostics
        sink = Sink()
        disturbance_diagnostics(loaded.program, sink)
        hints += [each.hint for each in sink.found]
    assert hints == [
        "other joints alone can correct it: give its torque an input, such as `u`",
        "nothing can correct it: give its torque an input, such as `u`",
    ]
