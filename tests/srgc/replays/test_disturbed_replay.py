"""``srgc replay --disturbed``: motions under disturbances, held against the certified tube."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from compiler.tasks.specification import UncertainMass
from srgc.exports.design_export import mujoco_text
from srgc.faults import UsageFault
from srgc.replays import disturbed_motions, disturbed_replay
from srgc.replays.disturbed_motions import DisturbanceBounds, Simulator, disturbances
from srgc.replays.disturbed_replay import DisturbedRequest
from srgc.results.found_design import FoundDesign, found_design
from tests.oracles import result_files
from tests.oracles.closed_chains import ClosedChain
from tests.srgc.conftest import Ran

Command = Callable[..., Ran]
Result = Callable[[str], Path]
pytestmark = pytest.mark.usefixtures("tubes_once")

KINDS = ("coordinates", "rates", "inputs")


def numbers(srgc: Command, folder: Path, *arguments: object) -> dict[str, Any]:
    ran = srgc("replay", folder, "--in", "mujoco", *arguments, "--json")
    assert (ran.status, ran.err) == (0, "")
    content = json.loads(ran.out)
    assert isinstance(content, dict)
    return content


# --- what disturbs a motion ----------------------------------------------------------------------


def test_motions_are_at_random_and_at_corners() -> None:
    drawn = disturbances(5, range(40), 7, 2, 3)
    assert drawn.start.shape == (40, 4)
    assert drawn.measured.shape == (40, 7, 4)
    assert drawn.inputs.shape == (40, 7, 3)
    for part in (drawn.start, drawn.mass, drawn.measured, drawn.inputs):
        assert (np.abs(part) <= 1).all()
        assert (np.abs(part[1::2]) == 1).all()
        assert np.abs(part[::2]).max() < 1
        assert part[::2].min() < -0.8
        assert part[::2].max() > 0.8
    steady = drawn.measured[1::4]
    assert (steady == steady[:, :1]).all()
    changing = drawn.inputs[3::4]
    assert (changing != changing[:, :1]).any(axis=(1, 2)).all()


def test_a_motion_depends_on_the_seed_and_its_number_alone() -> None:
    several, one = disturbances(5, range(9), 4, 2, 2), disturbances(5, [7], 4, 2, 2)
    other = disturbances(6, [7], 4, 2, 2)
    for part in ("start", "mass", "measured", "inputs"):
        np.testing.assert_array_equal(getattr(several, part)[7:8], getattr(one, part))
    assert not np.array_equal(one.measured, other.measured)


def by_hand(design: FoundDesign, bounds: DisturbanceBounds, seed: int, number: int) -> np.ndarray:
    """The states (k + 1, 2) of a rod that turns about its end: I q'' = u, so exactly."""
    claim = design.claim
    assert claim.controller is not None
    (length,) = (float(each.value) for each in claim.parameters)
    drawn = disturbances(seed, [number], design.task.steps, 1, 1)
    dt = float(design.task.step)
    inertia = (1 + bounds.mass * drawn.mass[0]) * length**3 / 3
    state = np.array([float(each) for each in claim.start]) + bounds.start * drawn.start[0]
    found = [state]
    for k, planned in enumerate(claim.inputs):
        reference = np.array([float(each) for each in claim.controller.reference[k]])
        gains = np.array([float(each) for each in claim.controller.gains[k][0]])
        read = state + bounds.measured * drawn.measured[0, k]
        u = float(planned[0]) - gains @ (read - reference)
        u += (bounds.part * abs(u) + bounds.most[0]) * drawn.inputs[0, k, 0]
        q, w = found[-1]
        state = np.array([q + w * dt + u / inertia * dt**2 / 2, w + u / inertia * dt])
        found.append(state)
    return np.array(found)


def test_the_closed_loop_is_that_of_the_certificate(made: Result) -> None:
    """All kinds of disturbances at once, far larger than those of the task, a loop by hand."""
    design = found_design(made("closed") / "out")
    bounds = DisturbanceBounds(
        np.array([0.05, 0.1]), np.array([0.01, 0.03]), 0.04, np.array([0.3]), 0.25
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(disturbed_motions, "disturbance_bounds", lambda _design: bounds)
        # Motions that do not fit into memory together are simulated one after the other.
        patch.setattr(disturbed_motions, "MOST_NUMBERS", 3 * 20 * 4)
        simulator = Simulator(mujoco, mujoco_text(design), design, "rk4", 1)
        found = simulator.motions(disturbances(11, range(5), design.task.steps, 1, 1), 20)
    for number in range(5):
        wanted = by_hand(design, bounds, 11, number)
        np.testing.assert_allclose(found.states[number], wanted, rtol=0, atol=1e-11)


def test_neither_ranges_nor_bounds_of_motors_help(made: Result) -> None:
    """A link beyond its range with a torque beyond its bound goes on freely."""
    design = found_design(made("closed") / "out")
    bounds = DisturbanceBounds(np.array([4.0, 0.0]), np.zeros(2), 0.0, np.array([50.0]), 0.0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(disturbed_motions, "disturbance_bounds", lambda _design: bounds)
        simulator = Simulator(mujoco, mujoco_text(design), design, "rk4", 2)
        found = simulator.motions(disturbances(0, [1], design.task.steps, 1, 1), 40)
    np.testing.assert_allclose(found.states[0], by_hand(design, bounds, 0, 1), rtol=1e-9)


def test_masses_of_single_modules_are_those_of_a_chain_by_hand(made: Result) -> None:
    """Two links, all masses off together and those of the first by themselves, and far off."""
    design = found_design(made("pair") / "out")
    (own,) = disturbed_motions.module_masses(design)
    assert (own.part, own.bodies) == (Fraction(2, 1000), (0,))
    still, none = np.zeros(4), np.zeros(2)
    heavy = (UncertainMass(Fraction(3, 10), (0,)),)
    bounds = DisturbanceBounds(still, still, 0.0, none, 0.2, heavy)
    drawn = disturbances(4, range(4), design.task.steps, 2, 2, 1)
    assert abs(drawn.masses[1, 0]) == 1 > abs(drawn.masses[2, 0])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(disturbed_motions, "disturbance_bounds", lambda _design: bounds)
        simulator = Simulator(mujoco, mujoco_text(design), design, "rk4", 1)
        found = simulator.motions(drawn, 400)
    folder = made("pair") / "out"
    text = (made("pair") / "pair.srg").read_text(encoding="utf-8")
    for clause in ("effort 0.3", "measure 0.02", "start 0.2"):
        text = text.replace(f"robust {clause}", f"robust {clause.split()[0]} 0")
    text = text.replace("robust mass 0.1 %", "robust mass 20 %")
    text = text.replace("robust mass 0.2 % of L", "robust mass 30 % of L")
    chain = ClosedChain(result_files.read(folder), text, lambda _: [1.3, 0.9], (1.0, 1.5), "LK")
    for number in range(4):
        factors = np.array([drawn.masses[number, 0], 0.0, drawn.mass[number]])
        corner = replace(chain.still(), factors=factors)
        states, _ = chain.motion(corner)
        np.testing.assert_allclose(found.states[number, -1], states[-1], rtol=0, atol=1e-8)


# --- none leaves the tube ------------------------------------------------------------------------


def test_none_leaves_the_tube(srgc: Command, made: Result) -> None:
    folder = made("closed") / "out"
    asked = ("--disturbed", 12, "--seed", 3, "--timestep", "0.01")
    found = numbers(srgc, folder, *asked)
    assert (found["motions"], found["seed"], found["left"]) == (12, 3, [])
    assert (found["timestep"], found["samples"], found["again"]) == (0.01, 11, 8)
    assert (found["version"], found["certificate"]) == (mujoco.__version__, "valid")
    for kind in KINDS:
        assert 0.1 < found[kind]["share"] < 1
        assert found[kind]["outside"] == 0
        assert found[kind]["error"] < 1e-11
        assert 0 <= found[kind]["motion"] < 12
    assert found == numbers(srgc, folder, *asked)
    ran = srgc("replay", folder, "--in", "mujoco", *asked)
    assert ran.status == 0
    lines = ran.out.splitlines()
    assert lines[0] == "in MuJoCo, rk4, steps of 0.01 s; 12 disturbed motions, seed 3"
    assert lines[1] == "left the tube:  0 of 12"
    assert lines[5].startswith("compared at 11 samples; errors of the integration by half the step")


@pytest.mark.slow
def test_none_leaves_the_tube_with_masses_of_single_modules(srgc: Command, made: Result) -> None:
    asked = ("--disturbed", 12, "--seed", 3, "--timestep", "0.02")
    found = numbers(srgc, made("pair") / "out", *asked)
    assert (found["motions"], found["left"], found["certificate"]) == (12, [], "valid")
    for kind in KINDS:
        assert 0.1 < found[kind]["share"] < 1


def test_those_that_leave_it_are_counted(
    srgc: Command, result: Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Errors are three times as large as the proof allows for."""
    folder = result("closed")
    allowed = disturbed_motions.disturbance_bounds(found_design(folder))
    wide = replace(allowed, start=3 * allowed.start, most=3 * allowed.most)
    monkeypatch.setattr(disturbed_motions, "disturbance_bounds", lambda _design: wide)
    ran = srgc("replay", folder, "--in", "mujoco", "--disturbed", 9, "--timestep", "0.02", "--json")
    assert (ran.status, ran.err) == (1, "")
    found = json.loads(ran.out)
    # At corners all of them begin outside.
    assert {1, 3, 5, 7} <= set(found["left"])
    assert found["again"] == max(8, len(found["left"]))
    # A start is outside by two radii.
    assert found["coordinates"]["outside"] >= 2 * allowed.start[0] - 1e-9
    text = srgc("replay", folder, "--in", "mujoco", "--disturbed", 9, "--timestep", "0.02")
    assert f"left the tube:  {len(found['left'])} of 9 (number " in text.out
    assert " outside; error" in text.out


def test_a_wrong_tube_is_noticed(
    srgc: Command, result: Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A tube of other bounds than the task has: half as wide as it has to be."""
    folder = result("closed")
    tube = disturbed_replay.found_tube(folder)
    middle = tube.samples.mean(axis=-1, keepdims=True)
    narrow = replace(tube, samples=middle + (tube.samples - middle) / 2)
    monkeypatch.setattr(disturbed_replay, "found_tube", lambda _folder: narrow)
    ran = srgc("replay", folder, "--in", "mujoco", "--disturbed", 8, "--timestep", "0.02")
    assert ran.status == 1
    assert "outside; error" in ran.out


def test_numbers_may_be_any(made: Result) -> None:
    """Parts of a long run have the motions of the whole."""
    folder = made("closed") / "out"
    asked = DisturbedRequest(range(6, 9), 3, disturbed_replay.USUAL_STEP * 100)
    told: list[tuple[int, int]] = []
    found = disturbed_replay.disturbed_replay(folder, asked, lambda *done: told.append(done))
    assert told == [(step, 10) for step in range(1, 11)]
    assert found.left == ()
    assert found.again == 3
    assert found.coordinates is not None
    assert found.coordinates.motion in (6, 7, 8)


# --- what cannot be replayed ---------------------------------------------------------------------


@pytest.mark.parametrize(
    ("spec", "options", "said"),
    [
        ("turner", ("--in", "mujoco", "--disturbed", 3), "the task names no disturbances"),
        ("closed", ("--in", "python", "--disturbed", 3), "--disturbed goes with --in mujoco"),
        (
            "closed",
            ("--in", "mujoco", "--disturbed", 3, "--halvings", 1),
            "without --halvings",
        ),
        ("closed", ("--in", "mujoco", "--seed", 3), "--seed goes with --disturbed"),
        ("closed", ("--in", "mujoco", "--disturbed", 0), "0 is not in the range"),
        (
            "closed",
            ("--in", "mujoco", "--disturbed", 1000000),
            "fewer motions",
        ),
    ],
    ids=[
        "no disturbances",
        "python",
        "halvings",
        "a seed alone",
        "no motion",
        "too many",
    ],
)
def test_what_is_refused(
    srgc: Command, made: Result, spec: str, options: tuple[object, ...], said: str
) -> None:
    ran = srgc("replay", made(spec) / "out", *options)
    assert (ran.status, ran.out) == (2, "")
    assert said in " ".join(ran.err.split())


def test_a_robot_with_states_of_its_own_is_refused(srgc: Command, result: Result) -> None:
    """Of a motor MJCF has no current, disturbed or not."""
    folder = result("motor")
    result_files.alter_spec(folder, "  horizon", "  robust start 0.1 deg;\n  horizon", sign=True)
    ran = srgc("replay", folder, "--in", "mujoco", "--disturbed", 3)
    assert (ran.status, ran.out) == (2, "")
    assert "MJCF does not hold" in ran.err


def test_a_simulation_that_diverges_is_refused(
    made: Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    design = found_design(made("closed") / "out")
    bounds = DisturbanceBounds(np.array([0.0, 1e308]), np.zeros(2), 0.0, np.array([1e308]), 0.0)
    monkeypatch.setattr(disturbed_motions, "disturbance_bounds", lambda _design: bounds)
    simulator = Simulator(mujoco, mujoco_text(design), design, "rk4", 1)
    with pytest.raises(UsageFault, match="diverges"):
        simulator.motions(disturbances(0, [1], design.task.steps, 1, 1), 1)
