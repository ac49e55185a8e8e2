"""Loops that come back by whole turns, of a rod whose rounds are known exactly."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pytest

from compiler.robots.robot import RobotModel
from grammar_lang.load import load_text
from solvers.verifier.proofs.control_law import ControlLaw
from solvers.verifier.proofs.loop_set import Loop
from solvers.verifier.proofs.trajectory_proof import Motion, Scene, prove_motion
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles.altered_claims import Change, Content, claimed, judged
from tests.oracles.exported_controllers import COMPILERS, compiled, module
from tests.oracles.result_files import read
from tests.oracles.small_specs import TURNER, replaced
from tests.oracles.some_cases import some
from tests.solvers.test_disturbed_proof import FAMILY, ONE, scene

F = Fraction
STEPS, STEP = 64, F(1, 10)
INERTIA = F(13, 10) ** 3 / 3
GAIN = F(4), F(3)
"""N*m/rad and N*m*s/rad."""
RATE = F(981748, 10**6)
"""A whole turn in 6.4 s, but for 1e-6 rad."""
CLOSE = 3e-6
"""By such a part of a set its enclosure is larger after a round."""
BACK = "return of the loop"


@lru_cache
def rod(clauses: str = "satisfy always eventually End;") -> Scene:
    text = FAMILY.replace(" in [-2, 2] rad rate in [-3, 3] rad/s", "").replace("CLAUSES", clauses)
    text = text.replace("STEPS", f"{STEPS}").replace("REGION", "box [0.9, 3] x [-1, 1]")
    return scene(ONE, text.replace("DISTURBANCES", "repeat;"))


@dataclass(frozen=True)
class Winding:
    """A rod that turns at a constant rate, and the set of states about its start."""

    rate: Fraction = RATE
    size: tuple[Fraction, Fraction] = (F(1, 100), F(1, 50))

    def motion(self, turns: tuple[int, ...]) -> Motion:
        states = [(self.rate * STEP * k, self.rate) for k in range(STEPS)]
        law = ControlLaw(tuple(states), ((GAIN,),) * STEPS)
        loop = Loop(0, states[0], ((self.size[0], F(0)), (F(0), self.size[1])), turns)
        return Motion((), states[0], ((F(0),),) * STEPS, 0, (), law, loop)

    def reach(self, turns: int) -> float:
        """How far motions from the set get after a round, in its size: at most 1 in it."""
        step = np.array([[1, float(STEP)], [0, 1]])
        push = np.array([float(STEP) ** 2 / 2, float(STEP)]) / float(INERTIA)
        once = step - np.outer(push, [float(gain) for gain in GAIN])
        image = np.abs(np.linalg.matrix_power(once, STEPS)) @ np.array(self.size, float)
        image[0] += abs(float(self.rate * STEP * STEPS) - 2 * pi * turns)
        return float(np.max(image / np.array(self.size, float)))


def said(where: Scene, motion: Motion) -> dict[str, tuple[Status, float]]:
    places = [where.abstraction.containing(tip(k, motion))[0] for k in range(STEPS + 1)]
    path = (tuple(where.abstraction.cells[place].name for place in places),)
    given = Motion((), motion.state, motion.inputs, 0, path, motion.law, motion.loop)
    return {each.name: (each.status, each.margin) for each in prove_motion(where, given)}


def tip(sample: int, motion: Motion) -> tuple[Fraction, Fraction]:
    angle = float(motion.state[1] * STEP * sample)
    return F(1.3 * cos(angle)), F(1.3 * sin(angle))


@pytest.mark.parametrize("rate", [RATE, -RATE])
def test_a_whole_turn_is_a_return(rate: Fraction) -> None:
    winding, turn = Winding(rate), 1 if rate > 0 else -1
    found = said(rod(), winding.motion((turn,)))
    assert all(status is Status.HOLDS for status, _ in found.values()), found
    assert found[BACK][1] == pytest.approx(1 - winding.reach(turn), abs=CLOSE)


@pytest.mark.parametrize("turns", [(), (0,), (2,), (-1,)])
def test_another_number_of_turns_is_none(turns: tuple[int, ...]) -> None:
    found = said(rod(), Winding().motion(turns))
    status, margin = found[BACK]
    assert status is Status.UNDECIDED
    assert margin == pytest.approx(1 - Winding().reach(*(turns or (0,))), rel=1e-5)


@pytest.mark.parametrize(("beyond", "believed"), [(-1e-5, True), (1e-6, False)])
def test_a_round_that_leaves_its_set_by_a_millionth_is_not_believed(
    beyond: float, believed: bool
) -> None:
    """A turn that is too long by so much that the set is left by a millionth, or just not."""
    low, high = RATE, RATE * F(101, 100)
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if Winding(middle).reach(1) < 1 + beyond else (low, middle)
    found = said(rod("satisfy always not Post;"), Winding(low).motion((1,)))
    assert (found[BACK][0] is Status.HOLDS) is believed
    assert found[BACK][1] == pytest.approx(-beyond, abs=CLOSE)


def test_more_turns_than_joints_are_no_loop() -> None:
    with pytest.raises(ValueError, match="no more joints than there are"):
        Loop(0, (F(0), F(0)), ((F(1), F(0)), (F(0), F(1))), (0, 0))


# --- Which joints may come back so ----------------------------------------------------------------


JOINT = "module JO { role joint; dof q: revolute z in [-180, 180] deg; }"
SLIDING = "module JO { role joint; dof q: prismatic x; }"


def motored(torque: str) -> str:
    return (
        "module JO { role joint; dof q: revolute z; const k = 1 N*m; const b = 1 N*m*s;\n"
        f"  state w = 0; der(w) = (u / k - w) / 1 s; torque(q) = {torque}; }}"
    )


@pytest.mark.parametrize(
    ("joint", "periodic"),
    [
        (JOINT, False),
        ("module JO { role joint; dof q: revolute z; }", True),
        (motored("u - b * rate(q) + k * w"), True),
        (motored("u - k * q + k * w"), False),
        (motored("u - k * sin(q) + k * w"), False),
    ],
    ids=["range", "none", "friction", "spring", "sine"],
)
def test_what_reads_the_angle_of_a_joint(joint: str, periodic: bool) -> None:
    text = replaced(TURNER, JOINT, joint)
    assert model_of(text).periodic == (periodic,)


def test_a_sliding_joint_does_not_turn() -> None:
    text = replaced(TURNER, JOINT, SLIDING).replace("rot(z, JO.q)", "move(x, JO.q)")
    text = replaced(text, "effort <= 10 N*m", "effort <= 10 N")
    assert model_of(text).periodic == (False,)


def model_of(text: str) -> RobotModel:
    from compiler.robots.normal_form import family_of

    program = load_text(text, "spec.srg").program
    assert program is not None
    family = family_of(program, program.tasks["Turn"])
    return family.robot(family.replay(("tool", "link", "joint", "base")))


# --- Claims ---------------------------------------------------------------------------------------


def turns(value: object) -> Change:
    def change(content: Content) -> None:
        claimed(content, "loop")["turns"] = value

    return change


def test_a_winding_loop_is_found(made: Callable[[str], Path]) -> None:
    folder = made("winding") / "out"
    assert verify_directory(folder).outcome is Outcome.VALID
    assert claimed(read(folder), "loop")["turns"] in ([1], [-1])
    said = (made("winding") / "stdout").read_text(encoding="utf-8")
    assert (
        "repeats: from 0 s to 4 s again and again, for ever; joint 1 turns once a round\n" in said
    )


@pytest.mark.parametrize(
    ("value", "outcome", "reason"),
    [
        ([7], Outcome.UNDECIDED, BACK),
        pytest.param([0], Outcome.UNDECIDED, BACK, marks=pytest.mark.slow),
        pytest.param([10**4000], Outcome.UNDECIDED, BACK, marks=pytest.mark.slow),
        ([], Outcome.REFUTED, "the turns of the loop are not those of 1 joint"),
        ([1, 0], Outcome.REFUTED, "the turns of the loop are not those of 1 joint"),
        ([1.0], Outcome.REFUTED, "a whole number is expected"),
        ([True], Outcome.REFUTED, "a whole number is expected"),
        (["1"], Outcome.REFUTED, "a whole number is expected"),
        (1, Outcome.REFUTED, "a list of turns is expected"),
        (None, Outcome.REFUTED, "a list of turns is expected"),
    ],
)
def test_false_turns(
    result: Callable[[str], Path], value: object, outcome: Outcome, reason: str
) -> None:
    folder = result("winding")
    (folder / "design.json").unlink()
    found, why = judged(folder, turns(value))
    assert found is outcome
    assert reason in why


@pytest.mark.parametrize("factor", some([30, 1000], 1))
def test_a_set_that_is_too_large_proves_nothing_and_refutes_nothing(
    result: Callable[[str], Path], factor: int
) -> None:
    """The second round's reference is a whole turn farther: nothing jumps there."""
    folder = result("winding")
    (folder / "design.json").unlink()

    def wider(content: Content) -> None:
        found = claimed(content, "loop")
        found["generators"] = [
            [str(factor * Decimal(x)) for x in row] for row in found["generators"]
        ]

    outcome, why = judged(folder, wider)
    assert outcome is Outcome.UNDECIDED, why


def test_a_load_on_a_rail_does_not_turn(result: Callable[[str], Path]) -> None:
    folder = result("looped")
    (folder / "design.json").unlink()
    assert judged(folder, turns([0]))[0] is Outcome.VALID
    outcome, why = judged(folder, turns([1]))
    assert outcome is Outcome.REFUTED
    assert "whole turns change it" in why


# --- The controller, with a sensor that knows no turns --------------------------------------------


@pytest.fixture(scope="module")
def exported(made: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    from srgc.cli import run

    target = tmp_path_factory.mktemp("winding") / "controller"
    folder = str(made("winding") / "out")
    assert run(["export", folder, "--to", "controller", "-o", str(target)]) == 0
    return target


def test_five_rounds_with_an_angle_in_any_turn(made: Callable[[str], Path], exported: Path) -> None:
    """The rod is I q'' = u; it begins each round in the set, with a counted angle, or one turn."""
    controller, claim = module(exported / "controller.py"), read(made("winding") / "out")
    loop, length = claimed(claim, "loop"), float(claim["parameters"][0]["value"])
    into = np.linalg.inv(np.array(loop["generators"], float))
    state, inertia = np.array(claim["start"], float) + 0.003, length**3 / 3
    rng, dt, count = np.random.default_rng(3), float(Fraction(claim["step"])), len(claim["inputs"])
    for sample in range(5 * count):
        centred = (state[0] + pi) % (2 * pi) - pi
        angles = state[0], state[0] % (2 * pi), centred, centred + 2e5 * pi
        held = [controller.controller(sample, [angle, state[1]])[0] for angle in angles]
        assert held == pytest.approx([held[0]] * len(held), abs=1e-6)
        off = np.array([centred, state[1]]) - np.array(loop["centre"], float)
        off[0] = (off[0] + pi) % (2 * pi) - pi
        assert sample % count or np.abs(into @ off).max() <= 1
        u = held[sample % len(held)] + 0.03 * rng.choice((-1, 1))
        state += np.array([dt * state[1] + dt**2 / 2 * u / inertia, dt * u / inertia])
    assert abs(state[0] - float(claim["start"][0])) > 9 * pi


@pytest.mark.parametrize("kind", ["controller.c", "controller_single.c"])
@pytest.mark.parametrize("compiler", COMPILERS)
def test_c_takes_off_whole_turns(
    made: Callable[[str], Path], exported: Path, compiler: str, kind: str
) -> None:
    """By exact rationals; an angle that is too many turns away, or no number, is an error."""
    claim = read(made("winding") / "out")
    law = claimed(claim, "controller")
    source = exported / kind
    run = compiled(compiler, source, claim["task"], (2, 1))
    (most,) = {int(x) for x in re.findall(r"(\d+) turns away from the ref", source.read_text())}
    (stated,) = re.findall(r"inputs\[0\]: (\S+) N", source.read_text())
    assert most >= 2
    rng = np.random.default_rng(1)
    for _ in range(200):
        k, turns = int(rng.integers(40)), int(rng.integers(-most, most + 1))
        state = np.array(law["reference"][k], float) + rng.uniform(-0.01, 0.01, 2)
        given = float(state[0]) + 2 * pi * turns
        given = float(np.float32(given)) if "single" in kind else given
        found = run(k, [given, float(state[1])])
        assert found is not None
        exact = float(claim["inputs"][k][0]) - sum(
            float(gain) * (x - float(y))
            for gain, x, y in zip(law["gains"][k][0], state, law["reference"][k], strict=True)
        )
        # What the reading was rounded by is not the program's.
        read_off = abs(float(law["gains"][k][0][0]) * (given - 2 * pi * turns - state[0]))
        assert found[0] == pytest.approx(exact, abs=1.1 * float(stated) + read_off + 1e-9)
    for angle in (2 * pi * (most + 2), -2 * pi * (most + 2), float("inf"), float("nan")):
        assert run(0, [angle, 0.0]) is None


def test_python_refuses_what_is_too_far_away(exported: Path) -> None:
    controller = module(exported / "controller.py")
    for angle in (1e9, -1e9, float("inf"), float("nan")):
        with pytest.raises(ValueError, match="turns away"):
            controller.controller(0, [angle, 0.0])
