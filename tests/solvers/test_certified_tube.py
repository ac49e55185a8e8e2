"""The certified tube, for readers: it holds motions that other programs simulate."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from solvers.verifier.certified_tube import certified_tube
from solvers.verifier.report import Refused
from tests.oracles import result_files, two_rods

Result = Callable[[str], Path]


def disturbed(folder: Path) -> Path:
    """The folder, its task now with disturbances that the motion need not survive."""
    spec = folder / "spec" / "turner.srg"
    text = spec.read_text(encoding="utf-8")
    text = text.replace("  horizon ", "  robust start 0.2 deg; robust effort 1 %;\n  horizon ")
    spec.write_text(text, encoding="utf-8")
    digest = result_files.spec_digest({"turner.srg": text.encode()})
    result_files.alter(folder, lambda claim: claim.update(spec_sha256=digest), sign=True)
    return folder


def test_it_holds_a_simulated_motion_and_its_tip(result: Result) -> None:
    folder = result("planar_arm")
    tube = certified_tube(folder)
    times, states, tips = two_rods.simulated(result_files.read(folder))
    chosen = np.random.default_rng(1).choice(len(times), 200, replace=False)
    outside, off = tube.distances(times[chosen], states[chosen])
    assert outside.max() < 1e-9
    assert 0 < off.max() < 1e-8
    for number in chosen[:40]:
        box = tube.points_at(float(times[number]))[0]
        assert (box[:, 0] - 1e-9 <= tips[:, number]).all()
        assert (tips[:, number] <= box[:, 1] + 1e-9).all()
    assert not tube.disturbed
    assert tube.times[0] == 0
    assert tube.times[-1] == times[-1]


def test_boxes_of_segments_hold_all_of_them(result: Result) -> None:
    folder = result("planar_arm")
    tube = certified_tube(folder)
    times, states, tips = two_rods.simulated(result_files.read(folder))
    for number, (first, last) in enumerate(zip(tube.times, tube.times[1:], strict=False)):
        inside = (first <= times) & (times <= last)
        values = np.vstack([states[inside].T, tips[:, inside]])
        boxes = np.vstack([tube.coordinates[number], tube.rates[number], tube.points[number, 0]])
        assert (boxes[:, :1] - 1e-9 <= values).all()
        assert (values <= boxes[:, 1:] + 1e-9).all()


def test_a_state_elsewhere_is_outside(result: Result) -> None:
    tube = certified_tube(result("planar_arm"))
    bounds = tube.at(1.0)
    state = (bounds[:, 0] + bounds[:, 1]) / 2
    outside, off = tube.distances(
        np.array([1.0, 1.0]), np.array([state, state + np.array([0, 1e-3, 0, 0])])
    )
    assert outside[0].max() == 0
    assert outside[1] == pytest.approx([0, 1e-3, 0, 0], abs=1e-7)
    assert off[1] == pytest.approx([0, 1e-3, 0, 0], abs=1e-7)
    with pytest.raises(ValueError, match="lasts from 0 to"):
        tube.at(-0.1)
    with pytest.raises(ValueError, match="lasts from 0 to"):
        tube.points_at(float(tube.times[-1]) + 1e-6)


def test_it_holds_disturbed_motions_of_a_rod(result: Result) -> None:
    folder = disturbed(result("turner"))
    tube = certified_tube(folder)
    claim = result_files.read(folder)
    length = float(claim["parameters"][0]["value"])
    start, dt = [float(x) for x in claim["start"]], float(Fraction(claim["step"]))
    assert tube.disturbed
    widest = 0.0
    for angle, part in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        state = np.array([start[0] + angle * np.radians(0.2), start[1]])
        for number, row in enumerate(claim["inputs"]):
            pull = float(row[0]) * (1 + 0.01 * part) / (length**3 / 3)
            state = solve_ivp(lambda _t, x, pull=pull: [x[1], pull], (0, dt), state, rtol=1e-11).y[
                :, -1
            ]
            outside, off = tube.distances(np.array([(number + 1) * dt]), state[None])
            assert outside.max() < 1e-9
            widest = max(widest, off[0, 0])
    assert widest > np.radians(0.2)


def test_of_a_motor_the_own_state_is_no_coordinate(result: Result) -> None:
    folder = result("motor")
    tube = certified_tube(folder)
    start = [float(x) for x in result_files.read(folder)["start"]]
    assert tube.coordinates.shape[1:] == tube.rates.shape[1:] == (1, 2)
    assert tube.at(0.0).mean(axis=1) == pytest.approx(start, abs=1e-12)


def test_there_is_none_of_the_impossible(result: Result) -> None:
    with pytest.raises(Refused, match="no motion"):
        certified_tube(result("beyond_reach"))


def test_samples_of_a_closed_loop_hold_what_its_law_makes(result: Result) -> None:
    """The box of the start is exact but for its last digits; later ones are within the segments."""
    tube = certified_tube(result("closed"))
    widths = tube.samples[..., 1] - tube.samples[..., 0]
    assert widths[0] == pytest.approx(np.radians([1.0, 1.0]), rel=1e-7)
    assert len(tube.samples) == len(tube.sample_points) == len(tube.commanded) + 1
    for number, time in enumerate(np.linspace(0, tube.times[-1], len(tube.samples))):
        bounds = tube.at(float(time))
        assert (bounds[:, 0] <= tube.samples[number, :, 0] + 1e-12).all()
        assert (tube.samples[number, :, 1] <= bounds[:, 1] + 1e-12).all()
        points = tube.points_at(float(time))
        assert (points[..., 0] <= tube.sample_points[number, ..., 0] + 1e-12).all()


def test_stated_inputs_are_commanded_in_an_open_loop(result: Result) -> None:
    folder = result("turner")
    tube = certified_tube(folder)
    stated = np.array(result_files.read(folder)["inputs"], dtype=float)
    np.testing.assert_allclose(tube.commanded, np.stack([stated, stated], -1), rtol=1e-15)
    assert tube.samples.shape == (len(stated) + 1, 2, 2)
