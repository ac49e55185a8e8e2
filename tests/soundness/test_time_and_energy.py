"""Least times and energies of certificates, against closed forms and simulations by others."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from math import ceil, sqrt
from pathlib import Path
from shutil import copytree
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles.altered_claims import Content, claimed, judged
from tests.oracles.result_files import alter, read
from tests.oracles.slides import slides

HORIZON = "horizon 20 steps of 0.1 s;"


def timed(masses: str, minimize: str, steps: int = 40, **others: Any) -> str:
    """Slides whose motion may take up to so many steps."""
    text = slides(masses, **others)
    assert HORIZON in text
    return text.replace(HORIZON, f"horizon at most {steps} steps of 0.1 s; minimize {minimize};")


def found(text: str, folder: Path, *options: str) -> Path:
    (folder / "s.srg").write_text(text, encoding="utf-8")
    out = folder / "out"
    assert run(["synth", str(folder / "s.srg"), "-o", str(out), "-q", *options]) == 0
    assert verify_directory(out).outcome is Outcome.VALID
    return out


def objective(folder: Path, name: str) -> Content:
    (entry,) = (
        each for each in read(folder, "design.json")["objectives"] if each["objective"] == name
    )
    return dict(entry)


@pytest.mark.parametrize(
    ("mass", "goal", "way", "end"),
    [(2.0, "1.1, 1.4", 0.8, "at rest"), (5.0, "0.7, 0.9", 0.4, ""), (3.0, "1.1, 1.4", 0.8, "")],
)
def test_least_times_of_slides(
    mass: float, goal: str, way: float, end: str, tmp_path: Path
) -> None:
    """Full force one way, and the other way if it has to stop; a sample is 0.1 s."""
    out = found(timed(f"const mass = {mass} kg", "time", goal=goal, end=end), tmp_path)
    least = 2 * sqrt(mass * way / 20) if end else sqrt(2 * mass * way / 20)
    samples = ceil(round(least / 0.1, 6))
    entry = objective(out, "time")
    assert entry["unit"] == "s"
    assert samples <= round(entry["value"] / 0.1) <= samples + 1
    assert round(entry["least"] / 0.1) <= samples
    assert round(entry["least"] / 0.1) >= samples - 1
    assert read(out)["steps"] == round(entry["value"] / 0.1)


@pytest.mark.parametrize(
    ("end", "fewest"),
    [("", 1), ("at rest for 0.45 s", 5)],
)
def test_no_motion_is_shorter_than_the_task_allows(end: str, fewest: int, tmp_path: Path) -> None:
    """A robot that stands in its target has the least time, which needs no evidence."""
    out = found(timed("const mass = 2 kg", "time", goal="0.1, 0.3", end=end, steps=8), tmp_path)
    shortest = Fraction(fewest, 10)
    assert read(out)["steps"] == fewest
    (claim,) = (each for each in read(out)["claims"] if each["kind"] == "objectives")
    assert claim["time"] is None
    assert [(Fraction(each["value"]), Fraction(each["least"])) for each in claim["values"]] == [
        (shortest, shortest)
    ]
    assert not (out / "proofs" / "time").exists()


def test_a_motion_may_have_fewer_steps_than_its_way_has_cells(tmp_path: Path) -> None:
    """320 N are enough for one step of 0.1 s, and the way leads through three cells."""
    strong = timed("const mass = 2 kg", "time", steps=12, effort="effort <= 2000 N;", end="")
    out = found(strong, tmp_path)
    assert read(out)["steps"] == 1
    assert objective(out, "time")["least"] == objective(out, "time")["value"] == 0.1


def test_samples_may_pass_cells_by(tmp_path: Path) -> None:
    """Between two samples the mass crosses a strip of 2 cm, which divides the way."""
    text = timed("const mass = 2 kg", "time")
    strip = "region Strip box [0.6, 0.62] x [-1, 1] m;"
    divided = text.replace("target Goal", f"{strip} target Goal")
    assert strip in divided
    out = found(divided, tmp_path)
    assert any("Strip" not in path for path in read(out)["path"])
    assert read(out)["steps"] <= ceil(2 * sqrt(2 * 0.8 / 20) / 0.1) + 1


def test_the_faster_of_two_drives_is_found(tmp_path: Path) -> None:
    out = found(timed("const mass = 8 kg; const mass = 2 kg", "time", kinds="Slow Fast"), tmp_path)
    assert read(out)["word"][2] == "Fast"
    assert objective(out, "time")["least"] <= objective(out, "time")["value"]


def test_no_more_time_than_a_fixed_horizon_takes(tmp_path: Path) -> None:
    """Whatever number of steps is found alone, ``at most`` finds no more of them."""
    at_most = timed("const mass = 2 kg", "time", steps=16)
    out = found(at_most, tmp_path)
    taken = read(out)["steps"]
    for steps in (6, 9, 12, 16):
        fixed = slides("const mass = 2 kg", steps=steps)
        (tmp_path / "f.srg").write_text(fixed, encoding="utf-8")
        status = run(["synth", str(tmp_path / "f.srg"), "-o", str(tmp_path / f"f{steps}"), "-q"])
        assert status in (0, 3, 4)
        assert status != 0 or taken <= steps


# --- altered claims of time -----------------------------------------------------------------------


@pytest.fixture(scope="module")
def timely(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("timely")
    return found(timed("const mass = 2 kg", "time"), folder)


def value(content: Content) -> Content:
    first = claimed(content, "objectives")["values"][0]
    assert isinstance(first, dict)
    return first


def time_of(content: Content) -> Content:
    found = claimed(content, "objectives")["time"]
    assert isinstance(found, dict)
    return found


def more(key: str, by: Fraction) -> Callable[[Content], None]:
    def change(content: Content) -> None:
        one = value(content)
        one[key] = str(Fraction(one[key]) + by)

    return change


def fewer_steps(content: Content) -> None:
    time_of(content)["steps"] -= 1


def more_steps(content: Content) -> None:
    time_of(content)["steps"] += 1
    more("least", Fraction(1, 10))(content)
    more("value", Fraction(1, 10))(content)


def no_evidence(content: Content) -> None:
    claimed(content, "objectives")["time"] = None


def no_structures(content: Content) -> None:
    time_of(content)["structures"] = []


def no_boxes(content: Content) -> None:
    time_of(content)["structures"][0]["boxes"] = None


def no_steps(content: Content) -> None:
    time_of(content)["steps"] = 0


@pytest.mark.parametrize(
    "change",
    [
        more("value", Fraction(1, 10)), more("value", Fraction(-1, 10)), more_steps, fewer_steps,
        more("least", Fraction(1, 10)), no_evidence, no_structures, no_boxes, no_steps,

    ],
)  # fmt: skip
def test_altered_times_are_refused(
    change: Callable[[Content], None], timely: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "out"
    copytree(timely, folder)
    (folder / "design.json").unlink()
    outcome, reason = judged(folder, change)
    assert outcome is Outcome.REFUTED, reason


def test_a_smaller_least_is_true_too(timely: Path, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    copytree(timely, folder)
    (folder / "design.json").unlink()
    outcome, reason = judged(folder, more("least", Fraction(-1, 10)))
    assert outcome is Outcome.VALID, reason


@pytest.mark.parametrize(("least", "outcome"), [("1/10", Outcome.VALID), ("2/10", Outcome.REFUTED)])
def test_without_evidence_the_least_is_what_the_task_allows(
    least: str, outcome: Outcome, timely: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "out"
    copytree(timely, folder)
    (folder / "design.json").unlink()

    def change(content: Content) -> None:
        no_evidence(content)
        value(content)["least"] = least

    assert judged(folder, change)[0] is outcome


def test_more_steps_than_are_allowed_are_refused(tmp_path: Path) -> None:
    """The motion of a longer task is no motion of one with fewer steps."""
    out = found(timed("const mass = 2 kg", "modules", steps=20), tmp_path)
    steps = read(out)["steps"]
    spec = next((out / "spec").iterdir())
    shorter = spec.read_text(encoding="utf-8").replace("at most 20", f"at most {steps - 1}")
    spec.write_text(shorter, encoding="utf-8")
    from tests.oracles.result_files import spec_digest

    name = spec_digest({spec.name: spec.read_bytes()})
    alter(out, lambda content: content.update(spec_sha256=name), sign=True)
    (out / "design.json").unlink()
    report = verify_directory(out)
    assert report.outcome is Outcome.REFUTED
    assert "steps" in (report.reason or "")


# --- energies -------------------------------------------------------------------------------------


def table(folder: Path) -> list[dict[str, float]]:
    with (folder / "trajectory.csv").open(encoding="utf-8") as file:
        rows = csv.DictReader(file)
        return [{key: float(text) for key, text in row.items() if text} for row in rows]


REACHER = """
module Base { role base; }
module Drive { role joint; dof q: revolute z in [-180, 180] deg rate in [-1, 1] rad/s; }
module Upper { role link; const length = 0.5 m; const mass = 0.2 kg; }
module Lower { role link; const length = 0.4 m; const mass = 0.2 kg; }
module Hand { role effector; }
edge e;
grammar Arm {
  start A; base: A -> Base; drive: A -> A e Drive; upper: A -> A e Upper; lower: A -> A e Lower;
  hand: A -> A e Hand;
  accept matches Base e Drive e Upper e Drive e Lower e Hand;
}
semantics Arm {
  base { this.at = world; }
  drive { this.at = A.at * rot(z, Drive.q); }
  upper { this.at = A.at * move(x, Upper.length); point(frame: this.at, mass: Upper.mass); }
  lower { this.at = A.at * move(x, Lower.length); point(frame: this.at, mass: Lower.mass); }
  hand { this.at = A.at; effector(frame: A.at); }
}
workspace W {
  plane xy; bounds box [-1, 1] x [-1, 1] m;
  region From box FROM m; target To box TO m;
}
task Go {
  robot Arm; workspace W; start in From at rest; reach To at rest;
  effort <= 50 N*m; horizon at most 60 steps of 0.1 s; minimize time;
}
"""


def branches(box: tuple[float, float, float, float]) -> np.ndarray:
    """Joint angles (m, 2) that put the hand of the reacher on a grid in a box, both elbows."""
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(*box[:2], 9), np.linspace(*box[2:], 9)))
    c = (x**2 + y**2 - 0.5**2 - 0.4**2) / (2 * 0.5 * 0.4)
    x, y, c = x[np.abs(c) <= 1], y[np.abs(c) <= 1], c[np.abs(c) <= 1]
    angles = []
    for elbow in (np.arccos(c), -np.arccos(c)):
        q = np.arctan2(y, x) - np.arctan2(0.4 * np.sin(elbow), 0.5 + 0.4 * np.cos(elbow))
        angles.append(np.stack([(q + np.pi) % (2 * np.pi) - np.pi, elbow], axis=1))
    return np.concatenate(angles)


@pytest.mark.parametrize(
    ("start", "goal"),
    [
        ((0.5, 0.55, 0.4, 0.45), (-0.6, -0.55, 0.4, 0.45)),
        ((0.3, 0.35, -0.65, -0.6), (0.1, 0.2, 0.6, 0.7)),
        ((0.62, 0.7, 0.6, 0.68), (-0.72, -0.66, 0.56, 0.62)),
    ],
)
def test_least_times_of_an_arm_whose_rates_are_limited(
    start: tuple[float, float, float, float],
    goal: tuple[float, float, float, float],
    tmp_path: Path,
) -> None:
    """Strong drives: no joint turns faster than it may, and the best pair of poses is near that."""
    from_text, to_text = (f"[{box[0]}, {box[1]}] x [{box[2]}, {box[3]}]" for box in (start, goal))
    out = found(REACHER.replace("FROM", from_text).replace("TO", to_text), tmp_path)
    turns = np.abs(branches(start)[:, None] - branches(goal)[None]).max(axis=2)
    least = float(turns.min())
    assert least - 0.1 <= objective(out, "time")["value"] <= least + 0.4


def test_the_energy_of_a_slide(tmp_path: Path) -> None:
    """The force is held within a step, and the mass does not turn back."""
    out = found(timed("const mass = 2 kg", "energy"), tmp_path)
    rows = table(out)
    energy = sum(abs(one["u1"]) * abs(two["q1"] - one["q1"]) for one, two in pairwise(rows))
    assert objective(out, "energy")["value"] == pytest.approx(energy, rel=1e-4)


PENDULUM = """
module Base { role base; }
module Drive { role joint; dof q: revolute z in [-180, 180] deg; }
module Rod { role link; const length = 0.6 m; const mass = 0.5 kg; }
module Hand { role effector; }
edge e;
grammar Arm {
  start A; base: A -> Base; drive: A -> A e Drive; rod: A -> A e Rod; hand: A -> A e Hand;
  accept matches Base e Drive e Rod e Hand;
}
semantics Arm {
  base { this.at = world; }
  drive { this.at = A.at * rot(z, Drive.q); }
  rod { this.at = A.at * move(x, Rod.length); point(frame: this.at, mass: Rod.mass); }
  hand { this.at = A.at; effector(frame: A.at); }
}
workspace W {
  plane xy; bounds box [-1, 1] x [-1, 1] m;
  region Low box [-0.05, 0.05] x [-0.65, -0.55] m; target High box [0.45, 0.6] x [-0.05, 0.25] m;
}
task Swing {
  robot Arm; workspace W; start in Low at rest; reach High at rest;
  gravity (0, -9.81) m/s^2; effort <= 6 N*m; horizon 20 steps of 0.1 s; minimize energy;
  control open loop;
}
"""


def test_the_energy_of_a_pendulum(tmp_path: Path) -> None:
    """Its motion integrated by another program, with the sizes of rates under the integral."""
    out = found(PENDULUM, tmp_path)
    rows = table(out)
    inputs = [row["u1"] for row in rows if "u1" in row]
    mass, length = 0.5, 0.6

    def rates(t: float, y: Any, u: float) -> list[float]:
        gravity = -mass * 9.81 * length * np.cos(y[0])
        return [y[1], (u + gravity) / (mass * length**2), abs(u * y[1])]

    state = [rows[0]["q1"], rows[0]["qd1"], 0.0]
    for u in inputs:
        solved = solve_ivp(rates, (0, 0.1), state, args=(u,), rtol=1e-10, atol=1e-12, max_step=1e-3)
        state = [float(x) for x in solved.y[:, -1]]
    assert objective(out, "energy")["value"] == pytest.approx(state[2], rel=2e-3)
    assert objective(out, "energy")["value"] >= state[2] * (1 - 1e-6)


@pytest.mark.parametrize("factor", [0.999, 1.001])
def test_altered_energies_are_refused(factor: float, tmp_path: Path) -> None:
    out = found(timed("const mass = 2 kg", "energy"), tmp_path)
    (out / "design.json").unlink()

    def change(content: Content) -> None:
        one = value(content)
        changed = str(Fraction(one["value"]) * Fraction(str(factor)))
        one.update(value=changed)

    assert judged(out, change)[0] is Outcome.REFUTED


def test_design_json_says_what_the_certificate_says(tmp_path: Path) -> None:
    out = found(timed("const mass = 2 kg", "time then energy"), tmp_path)
    path = out / "design.json"
    content = json.loads(path.read_text(encoding="utf-8"))
    content["objectives"][1]["value"] *= 1.01
    path.write_text(json.dumps(content), encoding="utf-8")
    assert verify_directory(out).outcome is Outcome.REFUTED
