"""What is proved of all disturbed motions, against closed forms and simulations by scipy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from math import cos, sin

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import working_precision
from compiler.robots.normal_form import family_of
from compiler.workspaces.abstraction import abstract
from grammar_lang import ir
from grammar_lang.ir import REST_RATE
from grammar_lang.load import load
from solvers.verifier.proofs.checked_condition import CheckedCondition, decisive
from solvers.verifier.proofs.disturbed_proof import disturbed_start
from solvers.verifier.proofs.trajectory_proof import Motion, Scene, prove_motion, scene_of
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.proofs.tube_proof import box_of, driven_robot
from tests.oracles.planar_chain import chain_dynamics

F = Fraction
FAMILY = """
module B { role base; }
module J { role joint; dof q: revolute z in [-2, 2] rad rate in [-3, 3] rad/s; }
module S { role joint; dof q: prismatic x in [-1, 3] m rate in [-4, 4] m/s; const mass = 1.5 kg; }
module L { role link; const length = 1.3 m; const density = 1 kg/m; }
module K { role link; const length = 0.9 m; const density = 1 kg/m; }
module E { role effector; }
edge eps;
grammar Arm {
  start N;
  base: N -> B; turn: N -> N eps J; slide: N -> N eps S; upper: N -> N eps L; fore: N -> N eps K;
  hand: N -> N eps E;
}
semantics Arm {
  base { this.frame = world; }
  turn { this.frame = N.frame * rot(z, J.q); }
  slide { this.frame = N.frame * move(x, S.q); point(frame: this.frame, mass: S.mass); }
  upper { this.frame = N.frame * move(x, L.length);
          rod(frame: N.frame, axis: x, length: L.length, density: L.density); }
  fore { this.frame = N.frame * move(x, K.length);
         rod(frame: N.frame, axis: x, length: K.length, density: K.density); }
  hand { this.frame = N.frame; effector(frame: N.frame); }
}
workspace W {
  plane xy; bounds box [-3, 3] x [-3, 3] m;
  region Begin box [-3, 3] x [-3, 3] m;
  region Post polytope { 3*x + 4*y <= 8.8; 3*x + 4*y >= 8; 4*x - 3*y <= 10; 4*x - 3*y >= 8; } m;
  region End REGION m;
}
task P {
  robot Arm; workspace W; start in Begin rates <= 1; CLAUSES
  effort <= 9 N*m; effort <= 9 N; horizon STEPS steps of 0.1 s; DISTURBANCES
}
"""
ONE = ("hand", "upper", "turn", "base")
TWO = ("hand", "fore", "turn", "upper", "turn", "base")
SLIDE = ("hand", "slide", "base")
INERTIA = 1.3**3 / 3


def scene(labels: Sequence[str], text: str) -> Scene:
    loaded = load_text(text)
    task = loaded.tasks["P"]
    family = family_of(loaded, task)
    derivation = family.replay(tuple(labels))
    cells = abstract(loaded.workspaces["W"])
    return scene_of(loaded, task, family.robot(derivation), cells, derivation)


@lru_cache
def load_text(text: str) -> ir.Program:
    import tempfile
    from pathlib import Path

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "spec.srg"
        path.write_text(text, encoding="utf-8")
        program = load(path).program
    assert program is not None
    return program


def spec(
    steps: int,
    disturbances: str,
    region: str = "box [-3, 3] x [-3, 3]",
    clauses: str = "reach End;",
) -> str:
    text = FAMILY.replace("STEPS", str(steps)).replace("DISTURBANCES", disturbances)
    return text.replace("REGION", region).replace("CLAUSES", clauses)


def proved(
    where: Scene,
    state: Sequence[Fraction],
    inputs: Sequence[Sequence[Fraction]],
    *,
    refute: bool = False,
) -> dict[str, CheckedCondition]:
    """The findings on a motion; its path of cells, which is about the plan alone, is left out."""
    task = replace(where.task, steps=len(inputs))
    where = replace(where, task=task)
    motion = Motion((), tuple(state), tuple(map(tuple, inputs)), 0, ())
    return {f.name: f for f in prove_motion(where, motion, refute=refute)}


# --- closed forms ---------------------------------------------------------------------------------


def near(found: CheckedCondition, plan: float, off: float) -> None:
    """A proved margin is never above the true one; what motions are off by counts at most twice."""
    assert found.status is Status.HOLDS
    assert plan - 2 * off - 0.05 * plan <= found.margin <= plan - off + 1e-9


@pytest.mark.parametrize("angle", [0.0, 0.01, 0.05])
@pytest.mark.parametrize("rate", [0.0, 0.04])
@pytest.mark.parametrize("part", [0.0, 0.03])
def test_one_rod(angle: float, rate: float, part: float) -> None:
    """Q = q0 + v0 t + u t^2 / 2 I, off by at most r + w t + p u t^2 / 2 I."""
    clauses = [f"robust start {angle} rad;"] * (angle > 0) + [f"robust start {rate} rad/s;"] * (
        rate > 0
    )
    clauses += [f"robust effort {100 * part} %;"] * (part > 0)
    q0, v0, u, time = F(3, 10), F(1, 5), F(4, 5), 1.2
    found = proved(scene(ONE, spec(12, " ".join(clauses))), (q0, v0), [(u,)] * 12)
    push = 0.8 / INERTIA
    q = 0.3 + 0.2 * time + push * time**2 / 2
    off = angle + rate * time + part * push * time**2 / 2
    near(found["range of J.q"], 2 - q, off)
    near(found["rate of J.q"], 3 - (0.2 + push * time), rate + part * push * time)
    assert found["start rates"].margin == pytest.approx(0.8)


def test_inputs_that_change_their_sign_err_all_the_time() -> None:
    """After u and -u for a second each the rates may be off by 2 p u / I: no errors cancel."""
    where = scene(ONE, spec(20, "robust effort 2 %;"))
    inputs = [(F(3, 5),)] * 10 + [(F(-3, 5),)] * 10
    found = proved(where, (F(0), F(0)), inputs)
    push = 0.6 / INERTIA
    near(found["range of J.q"], 2 - push, 0.02 * (push / 2 + push + push / 2))
    near(found["rate of J.q"], 3 - push, 0.02 * push)


def test_one_slide() -> None:
    """Lengths and speeds are those of slides; angles do not matter to them."""
    where = scene(SLIDE, spec(10, "robust start 1 cm, 2 cm/s, 1 rad, 1 rad/s; robust effort 5 %;"))
    found = proved(where, (F(1, 2), F(1, 5)), [(F(3),)] * 10)
    near(found["range of S.q"], 3 - (0.5 + 0.2 + 1.0), 0.01 + 0.02 + 0.05)
    near(found["rate of S.q"], 4 - (0.2 + 2.0), 0.02 + 0.1)
    near(found["bounds"], 3 - 1.7, 0.08)


def test_a_rest_at_the_end_is_about_all_motions() -> None:
    """A rod at rest stays so, but for its rate, which may be off by 0.9 of the bound, or by 1.1."""
    for share, status in ((F(9, 10), Status.HOLDS), (F(11, 10), Status.UNDECIDED)):
        rate = float(share * REST_RATE)
        text = spec(5, f"robust start {rate} rad/s;", clauses="reach End at rest;")
        found = proved(scene(ONE, text), (F(0), F(0)), [(F(0),)] * 5)
        assert found["rest at the end"].status is status
        if status is Status.HOLDS:
            assert found["rest at the end"].margin == pytest.approx(
                0.1 * float(REST_RATE), rel=0.05
            )


def test_the_radii_are_those_of_the_joints() -> None:
    """In absolute angles the second one is off by the sum of both: |y2| <= 2 r."""
    where = scene(TWO, spec(1, "robust start 0.01 rad, 0.03 rad/s;"))
    with working_precision(80):
        state = driven_robot(where, Motion((), (F(0),) * 4, ((F(0), F(0)),), 0, ())).state
        box = box_of(disturbed_start(where, state))
        radii = [float(item.rad()) for item in box]
    rows = np.array(where.graph.coordinates.rows, dtype=float)
    assert not np.array_equal(rows, np.eye(2))
    inverse = np.abs(np.linalg.inv(rows))
    expected = [*(inverse @ [0.01, 0.01]), *(inverse @ [0.03, 0.03])]
    assert radii == pytest.approx(expected, rel=1e-6)


# --- what is too wide, and what is false --------------------------------------------------------


def test_where_the_enclosure_outgrows_a_margin_its_time_is_said() -> None:
    """The rod gets to where 2 - q is what it may be off by, at a time of school physics."""
    where = scene(ONE, spec(15, "robust start 0.2 rad;"))
    inputs = [(F(4, 5),)] * 15
    found = proved(where, (F(3, 10), F(1, 5)), inputs)
    lost = decisive(tuple(found.values()))
    assert lost is not None
    assert (lost.name, lost.status) == ("range of J.q", Status.UNDECIDED)
    push = 0.8 / INERTIA
    time = (-0.2 + (0.04 + 2 * push * (2 - 0.2 - 0.3)) ** 0.5) / push
    assert lost.time == pytest.approx(time, abs=2e-3)
    said = "the enclosure of the disturbed motions outgrows the margin of `range of J.q`"
    assert lost.reason.startswith(f"{said} at {time:.2f}")
    assert found["bounds"].status is Status.HOLDS


def test_a_disturbed_motion_that_fails_is_shown() -> None:
    """The same range is passed for certain by a rod that starts at the end of the radius."""
    where = scene(ONE, spec(15, "robust start 0.2 rad; robust effort 1 %;"))
    found = proved(where, (F(3, 10), F(1, 5)), [(F(4, 5),)] * 15, refute=True)
    lost = found["range of J.q"]
    assert lost.status is Status.FAILS
    push, end = 0.8 / INERTIA, 1.5
    assert 0.3 + 0.2 * end + push * end**2 / 2 < 2
    assert 0.5 + 0.2 * end + 1.01 * push * end**2 / 2 > 2
    assert lost.reason.startswith("range of J.q: violated by a disturbed motion at ")


def test_a_target_that_is_missed() -> None:
    """The tip ends 0.02 rad within a sector; one that is off by 0.03 is not in it."""
    angle = 0.3 + 0.2 + 0.8 / INERTIA / 2
    normal = (-sin(angle + 0.02), cos(angle + 0.02))
    sector = f"{normal[0]:.9f}*x + {normal[1]:.9f}*y <= 0"
    region = f"polytope {{ {sector}; x >= -3; x <= 3; y >= -3; y <= 3; }}"
    for radius, status in ((0.015, Status.HOLDS), (0.03, Status.FAILS)):
        where = scene(ONE, spec(10, f"robust start {radius} rad;", region))
        found = proved(where, (F(3, 10), F(1, 5)), [(F(4, 5),)] * 10, refute=True)
        assert found["target End"].status is status


def test_where_the_enclosure_ends_nothing_is_said_to_hold_that_only_the_plan_does() -> None:
    """An arm that is off by half a radian and half the torque: no tube gets to the end."""
    clauses = "reach End; avoid Post with body; satisfy always not Post;"
    wide = "robust start 0.5 rad, 0.5 rad/s; robust effort 50 %;"
    start, inputs = (F(1, 5), F(7, 10), F(0), F(0)), [(F(2), F(1))] * 8
    plan = proved(scene(TWO, spec(8, "", clauses=clauses)), start, inputs)
    found = proved(scene(TWO, spec(8, wide, clauses=clauses)), start, inputs)
    (ended,) = [each for name, each in found.items() if name == "disturbed motions"]
    assert ended.time is not None
    assert 0 < ended.time < 0.8
    about_the_plan = {"mass matrix positive definite", "start Begin", "start rates"}
    holding = {name for name, each in found.items() if each.status is Status.HOLDS}
    assert about_the_plan <= holding <= about_the_plan | {"cell path"}
    assert found.keys() == plan.keys() | {"disturbed motions"}
    assert found["target End"].reason.startswith("the enclosure of the disturbed motions ends at ")


def test_what_the_plan_fails_is_not_blamed_on_disturbances() -> None:
    where = scene(ONE, spec(20, "robust start 0.01 rad;"))
    found = proved(where, (F(1), F(1)), [(F(2),)] * 20)
    lost = decisive(tuple(found.values()))
    assert lost is not None
    assert lost.status is Status.FAILS
    assert lost.why == ""


def test_two_conditions_of_one_name_are_both_kept() -> None:
    """A region avoided twice, with 0.2 m and with none: the first is lost, whatever the order."""
    region = "box [1.2, 1.4] x [0.3, 0.5]"
    for margins in ((", margin 20 cm", ""), ("", ", margin 20 cm")):
        avoided = " ".join(f"avoid End with effector{margin};" for margin in margins)
        where = scene(ONE, spec(2, "robust start 0.05 rad;", region, f"reach Begin; {avoided}"))
        motion = Motion((), (F(1, 20), F(0)), ((F(0),),) * 2, 0, ())
        where = replace(where, task=replace(where.task, steps=2))
        lost = [f for f in prove_motion(where, motion) if f.name == "clearance of effector to End"]
        assert {f.status for f in lost} == {Status.HOLDS, Status.UNDECIDED}


# --- two rods, simulated ------------------------------------------------------------------------


@dataclass(frozen=True)
class Planned:
    state: tuple[Fraction, ...]
    inputs: tuple[tuple[Fraction, ...], ...]
    angle: float = 0.004
    rate: float = 0.01
    part: float = 0.01


def planned(seed: int) -> Planned:
    rng = np.random.default_rng(seed)
    start = (F(1, 5), F(7, 10), F(int(rng.integers(-4, 5)), 10), F(int(rng.integers(-4, 5)), 10))
    pulls = rng.integers(-60, 60, (8, 2))
    return Planned(start, tuple(tuple(F(int(x), 100) for x in row) for row in pulls))


def disturbed(plan: Planned, seed: int) -> Array:
    """The states of a disturbed motion: inputs jump three times a step, to their ends mostly."""
    rng = np.random.default_rng(seed)
    ends = rng.choice([-1.0, 1.0], 4) if seed % 2 else rng.uniform(-1, 1, 4)
    state = np.array([float(x) for x in plan.state])
    state += ends * np.array([plan.angle, plan.angle, plan.rate, plan.rate])
    lengths, parts, states = np.array([1.3, 0.9]), 3, [state[None, :]]
    whole = rng.choice([-1.0, 1.0], 2)
    for row in plan.inputs:
        for _ in range(parts):
            factor = whole if seed % 4 == 1 else rng.choice([-1.0, 1.0], 2)
            torque = np.array([float(u) for u in row]) * (1 + plan.part * factor)

            def slope(_: float, x: Array, torque: Array = torque) -> Array:
                mass, coriolis, _ = chain_dynamics(lengths, np.ones(2), x[:2], x[2:], (0, 0))
                return np.concatenate([x[2:], np.linalg.solve(mass, torque - coriolis)])

            span = np.linspace(0, 0.1 / parts, 5)
            found = solve_ivp(
                slope, (0, span[-1]), states[-1][-1], t_eval=span, rtol=1e-8, atol=1e-9
            )
            states.append(found.y.T[1:])
    return np.concatenate(states)


def tips(states: Array) -> Array:
    total = states[:, 0] + states[:, 1]
    x = 1.3 * np.cos(states[:, 0]) + 0.9 * np.cos(total)
    y = 1.3 * np.sin(states[:, 0]) + 0.9 * np.sin(total)
    return np.stack([x, y], axis=1)


@pytest.mark.parametrize(
    "seed", [0, 1, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(2, 12))]
)
def test_no_disturbed_motion_has_less_than_the_proved_margins(seed: int) -> None:
    plan = planned(seed)
    text = spec(
        8,
        f"robust start {plan.angle} rad, {plan.rate} rad/s; robust effort {100 * plan.part} %;",
        clauses="reach End; satisfy always not Post;",
    )
    found = proved(scene(TWO, text), plan.state, plan.inputs)
    assert all(f.status is Status.HOLDS for f in found.values()), found
    states = np.concatenate([disturbed(plan, number) for number in range(8)])
    alone = disturbed(replace(plan, angle=0, rate=0, part=0), 0)
    for name, gaps in (
        ("bounds", _from_bounds),
        ("range of J.q (joint 2)", _of_range),
        ("rate of J.q (joint 2)", _of_rate),
    ):
        least, without = float(gaps(states).min()), float(gaps(alone).min())
        assert found[name].margin <= least + 1e-7
        assert found[name].margin >= without - 4 * (without - least) - 0.05 * without
    clear = float(_from_post(tips(states)).min())
    [formula] = [f for f in found.values() if f.clause == 0]
    assert 0 < formula.margin <= clear + 1e-7


def _from_bounds(states: Array) -> Array:
    found: Array = 3 - np.abs(tips(states))
    return found


def _of_range(states: Array) -> Array:
    found: Array = 2 - np.abs(states[:, 1])
    return found


def _of_rate(states: Array) -> Array:
    found: Array = 3 - np.abs(states[:, 3])
    return found


def _from_post(points: Array) -> Array:
    """The distance from a turned rectangle, in its own coordinates."""
    along = (3 * points[:, 0] + 4 * points[:, 1]) / 5
    across = (4 * points[:, 0] - 3 * points[:, 1]) / 5
    beyond = np.maximum(np.maximum(1.6 - along, along - 1.76), 0)
    beside = np.maximum(np.maximum(1.6 - across, across - 2), 0)
    found: Array = np.hypot(beyond, beside)
    return found
