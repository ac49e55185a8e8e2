"""``srgc export --to svg``: where the arm is drawn, against kinematics written by hand."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from srgc.cli import run

SVG = "{http://www.w3.org/2000/svg}"
NUMBER = re.compile(r"-?[0-9.]+")


def numbers(text: str | None) -> list[float]:
    return [float(each) for each in NUMBER.findall(text or "")]


@pytest.fixture(scope="module")
def picture(made: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("svg") / "arm.svg"
    assert run(["export", str(made("planar_arm") / "out"), "--to", "svg", "-o", str(path)]) == 0
    return path


def frames(path: Path) -> list[ElementTree.Element]:
    root = ElementTree.parse(path).getroot()
    return [each for each in root.iter(f"{SVG}g") if each.get("class") == "robot"]


def test_the_hand_is_where_the_joints_put_it(made: Callable[[str], Path], picture: Path) -> None:
    folder = made("planar_arm") / "out"
    design = json.loads((folder / "design.json").read_text())
    first, second = (each["value"] for each in design["parameters"])
    assert first != pytest.approx(second)
    with (folder / "trajectory.csv").open(newline="") as file:
        rows = {round(float(row["t"]), 6): row for row in csv.DictReader(file)}
    # The bounds are 5 m wide and have a corner at the origin, where the arm stands.
    root = ElementTree.parse(picture).getroot()
    (bounds,) = (e for e in root.iter(f"{SVG}g") if e.get("class") == "shape bounds")
    left, top, across, *_ = numbers(bounds[0].get("d"))
    scale = across / 5
    end, drawn, seen = design["step"] * design["horizon"], frames(picture), 0
    for number, frame in enumerate(drawn):
        time = number * end / (len(drawn) - 1)
        assert numbers(frame[-1].text)[0] == pytest.approx(time, abs=0.006)
        row = rows.get(round(time, 6))
        if row is None:
            continue
        seen += 1
        (hand,) = (each for each in frame if each.get("class") == "effector")
        x, y = numbers(hand.get("transform"))
        q1, q2 = float(row["q1"]), float(row["q2"])
        tip = first * np.exp(1j * q1) + second * np.exp(1j * (q1 + q2))
        assert (x - left) / scale == pytest.approx(tip.real, abs=0.1 / scale)
        assert 5 - (y - top) / scale == pytest.approx(tip.imag, abs=0.1 / scale)
    assert seen >= 5


def test_one_drawing_is_seen_at_every_time(picture: Path) -> None:
    shown = []
    for frame in frames(picture):
        (play,) = frame.iter(f"{SVG}animate")
        keys, values = numbers(play.get("keyTimes")), str(play.get("values")).split(";")
        assert len(keys) == len(values)
        shown.append((np.array(keys), values))
        assert play.get("repeatCount") == "indefinite"
    for time in np.linspace(0.0003, 0.9997, 500):
        visible = [
            number
            for number, (keys, values) in enumerate(shown)
            if values[int(np.searchsorted(keys, time, side="right")) - 1] == "visible"
        ]
        assert len(visible) == 1
    assert picture.stat().st_size < 1_000_000
    text = picture.read_text(encoding="utf-8")
    assert "<script" not in text
    assert "prefers-reduced-motion" in text


def test_long_drawings_are_fewer(
    made: Callable[[str], Path], picture: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "few.svg"
    monkeypatch.setattr("srgc.exports.motion_picture.LARGEST", 25_000)
    assert run(["export", str(made("planar_arm") / "out"), "--to", "svg", "-o", str(path)]) == 0
    many, few = frames(picture), frames(path)
    assert 12 < len(few) < len(many)
    drawn = path.read_text(encoding="utf-8").partition('<g class="robot"')[2]
    assert len(drawn.partition('<g class="names"')[0]) < 1.05 * 25_000
    for index in (0, -1):
        assert few[index][-1].text == many[index][-1].text
    clocks = np.array([numbers(frame[-1].text)[0] for frame in few])
    np.testing.assert_allclose(np.diff(clocks), clocks[-1] / (len(few) - 1), atol=0.011)
