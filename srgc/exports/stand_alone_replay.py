"""Replay the planned torques in MuJoCo, with the controller's gains, and compare with the plan.

It needs the files that were exported with it, in its own folder, and MuJoCo (pip install mujoco):

    python replay.py                    print the largest differences
    python replay.py --timestep 0.01    with simulation steps of at most this length (s)
    python replay.py --view             watch it
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
import time
from collections.abc import Iterator
from pathlib import Path

try:
    import mujoco
except ModuleNotFoundError:
    sys.exit("MuJoCo is not installed; it comes with: pip install mujoco")

FOLDER = Path(__file__).resolve().parent
MOST_STEPS = 100_000_000


def rows(name: str, *columns: str) -> list[dict[str, float]]:
    """Read a table of numbers with at least these columns; empty cells are left out."""
    try:
        with (FOLDER / name).open(encoding="utf-8", newline="") as file:
            table = [
                {key: float(cell) for key, cell in row.items() if cell}
                for row in csv.DictReader(file)
            ]
    except (OSError, ValueError, TypeError) as error:
        sys.exit(f"{name} cannot be read: {error}")
    for number, row in enumerate(table, start=2):
        lacking = [column for column in columns if not math.isfinite(row.get(column, math.nan))]
        if lacking:
            sys.exit(f"{name}, line {number}: there is no number for {lacking[0]}")
    return table


def columns(model: mujoco.MjModel) -> list[str]:
    """The names of positions, then of velocities."""
    joints = [model.joint(i).name for i in range(model.njnt)]
    return [f"{kind}.{joint}" for kind in ("position", "velocity") for joint in joints]


def planned(model: mujoco.MjModel) -> list[dict[str, float]]:
    """The samples of the planned motion."""
    return rows("trajectory.csv", "t", *columns(model))


def torques(model: mujoco.MjModel) -> list[dict[str, float]]:
    """The torques held in each step."""
    return rows("torques.csv", *(model.actuator(i).name for i in range(model.nu)))


def gains(model: mujoco.MjModel) -> list[dict[str, float]]:
    """The gains of torques per deviation in each step; empty for an open loop."""
    if not (FOLDER / "gains.csv").exists():
        return []
    motors = [model.actuator(i).name for i in range(model.nu)]
    found = rows(
        "gains.csv", *(f"{name} to {motor}" for name in columns(model) for motor in motors)
    )
    if len(found) != len(torques(model)):
        sys.exit("gains.csv does not have a row for every row of torques.csv")
    return found


def robots(model: mujoco.MjModel) -> list[mujoco.MjModel]:
    """The robot without loads, then with each set of loads that the column `robot` counts.

    All have the settings of the first.
    """
    found = [model]
    for number in range(1, 1 + max(int(row.get("robot", 0)) for row in torques(model))):
        name = f"robot_loaded_{number}.xml"
        try:
            text = (FOLDER / name).read_text(encoding="utf-8")
            loaded = mujoco.MjModel.from_xml_string(text)
        except (OSError, ValueError) as error:
            sys.exit(f"{name} cannot be loaded: {error}")
        loaded.opt.timestep, loaded.opt.disableflags = model.opt.timestep, model.opt.disableflags
        found.append(loaded)
    return found


def start(timestep: float | None) -> tuple[mujoco.MjModel, mujoco.MjData, int]:
    """Load the robot at its start, and count the simulation steps in a step of the task."""
    try:
        model = mujoco.MjModel.from_xml_string((FOLDER / "robot.xml").read_text(encoding="utf-8"))
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"robot.xml cannot be loaded: {error}")
    # A diverging simulation must not restart unnoticed.
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    mujoco.mj_forward(model, data)
    samples = planned(model)
    count = len(torques(model))
    if not 0 < count == len(samples) - 1:
        sys.exit("torques.csv does not have a row for every step of trajectory.csv")
    step = samples[-1]["t"] / count
    longest = timestep or model.opt.timestep
    if samples[-1]["t"] / longest > MOST_STEPS:
        sys.exit(f"that is more than {MOST_STEPS} steps; choose a longer --timestep")
    steps = max(1, math.ceil(step / longest - 1e-9))
    model.opt.timestep = step / steps
    return model, data, steps


def moved(model: mujoco.MjModel, data: mujoco.MjData, steps: int) -> Iterator[None]:
    """Hold each row of torques for its step, and yield after each simulation step."""
    samples, taken, loaded = planned(model), gains(model), robots(model)
    for step, row in enumerate(torques(model)):
        off = {
            f"{kind}.{joint.name}": float(value[0]) - samples[step][f"{kind}.{joint.name}"]
            for joint in map(data.joint, range(model.njnt))
            for kind, value in (("position", joint.qpos), ("velocity", joint.qvel))
        }
        for i in range(model.nu):
            motor, gain = model.actuator(i).name, taken[step] if taken else {}
            less = sum(gain.get(f"{name} to {motor}", 0.0) * value for name, value in off.items())
            data.ctrl[i] = row[motor] - less
        for _ in range(steps):
            mujoco.mj_step(loaded[int(row.get("robot", 0))], data)
            yield


def differences(model: mujoco.MjModel, data: mujoco.MjData, steps: int) -> tuple[float, float]:
    """The largest differences in a position and in a velocity at the samples of the plan."""
    samples = planned(model)
    largest = [0.0, 0.0]

    def compare(row: dict[str, float]) -> None:
        for i in range(model.njnt):
            joint = data.joint(i)
            for k, (kind, value) in enumerate((("position", joint.qpos), ("velocity", joint.qvel))):
                gap = abs(float(value[0]) - row[f"{kind}.{joint.name}"])
                if not math.isfinite(gap):
                    sys.exit(f"the simulation diverges with steps of {model.opt.timestep:g} s")
                largest[k] = max(largest[k], gap)

    compare(samples[0])
    for number, _ in enumerate(moved(model, data, steps), start=1):
        if number % steps == 0:
            compare(samples[number // steps])
    return largest[0], largest[1]


def view(model: mujoco.MjModel, data: mujoco.MjData, steps: int) -> None:
    """Show the motion repeatedly until the window is closed."""
    import mujoco.viewer

    with mujoco.viewer.launch_passive(model, data) as window:
        while window.is_running():
            mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
            begun = time.monotonic()
            for _ in moved(model, data, steps):
                if not window.is_running():
                    return
                ahead = data.time - (time.monotonic() - begun)
                if ahead > 0:
                    window.sync()
                    time.sleep(ahead)
            window.sync()
            time.sleep(1)


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description="Hold the planned torques in MuJoCo.")
    parser.add_argument("--timestep", type=float, help="longest step of the simulation, in seconds")
    parser.add_argument("--view", action="store_true", help="watch it")
    options = parser.parse_args()
    if options.timestep is not None and not options.timestep > 0:
        parser.error("--timestep must be positive")
    model, data, steps = start(options.timestep)
    if options.view:
        view(model, data, steps)
        return
    position, velocity = differences(model, data, steps)
    sys.stdout.write(
        f"steps of {model.opt.timestep:g} s\n"
        f"largest difference of a position: {position:.2e} rad (m)\n"
        f"largest difference of a velocity: {velocity:.2e} rad/s (m/s)\n"
    )


if __name__ == "__main__":
    main()
