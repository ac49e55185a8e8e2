"""Maps of obstacles on the command line: notes, plans through gaps, and every bad input."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.oracles.small_specs import SLIDER
from tests.srgc.conftest import Ran

Run = Callable[..., Ran]

SPEC = """\
module B { role base; }
module P { role joint; dof q: prismatic x in [0, 4] m; }
module Q { role joint; dof q: prismatic y in [0, 4] m; }
module E { role effector; }

grammar Gantry {
  start N;
  whole: N -> B P Q E;
}

semantics Gantry {
  whole {
    this.cart = move(x, P.q);
    this.tip = this.cart * move(y, Q.q);
    point(frame: this.cart, mass: 1 kg);
    point(frame: this.tip, mass: 1 kg);
    effector(frame: this.tip);
  }
}

workspace Yard {
  plane xy;
  bounds box [0, 4] x [0, 4] m;
  region Gate box [0.2, 0.8] x [0.2, 0.8] m;
  target Shed box [3.2, 3.8] x [0.2, 0.8] m;
  obstacles from "maps/yard.yaml";
}

task Push {
  robot Gantry;
  workspace Yard;
  start in Gate;
  reach Shed;
  avoid yard with effector;
  effort <= 20 N;
  horizon 40 steps of 0.1 s;
}
"""
YAML = """\
image: yard.pgm
resolution: 0.1
origin: [0, 0, 0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""
BIG = [[0, 0], [9, 0], [0, 9], [0, 0]]
CROSSED = [[1, 1], [2, 2], [2, 1], [1, 2], [1, 1]]
GREY = 205
"""What map_saver writes where it knows nothing."""


def pgm(pixels: np.ndarray) -> bytes:
    file = BytesIO()
    Image.fromarray(pixels.astype(np.uint8)).save(file, "PPM")
    return file.getvalue()


def wall(*, gap: bool = True) -> np.ndarray:
    """A wall at x from 1.9 to 2.1 m, unknown above y = 3.5 m, free from y = 3 m on if a gap."""
    pixels = np.full((40, 40), 254)
    pixels[:, 19:21] = 0
    if gap:
        pixels[5:10, 19:21] = 254
    pixels[:5, 19:21] = GREY
    return pixels


@pytest.fixture
def yard(tmp_path: Path) -> Callable[..., Path]:
    """A specification with a map in its folder ``maps``."""

    def write(
        yaml: str | bytes = YAML, image: bytes | None = None, text: str = SPEC, **more: str
    ) -> Path:
        path = tmp_path / "spec.srg"
        path.write_text(text)
        (tmp_path / "maps").mkdir(exist_ok=True)
        (tmp_path / "maps" / "yard.yaml").write_bytes(
            yaml if isinstance(yaml, bytes) else yaml.encode()
        )
        (tmp_path / "maps" / "yard.pgm").write_bytes(pgm(wall()) if image is None else image)
        for name, content in more.items():
            (tmp_path / "maps" / f"{name}.geojson").write_text(content)
        return path

    return write


def test_a_plan_goes_through_the_gap(srgc: Run, yard: Callable[..., Path]) -> None:
    path = yard()
    ran = srgc("check", path)
    assert ran.status == 0
    said = "obstacle `yard`: 2 convex pieces from 70 occupied and unknown cells of 0.1 m"
    assert f"note[SRG0611]: {said}\n" in ran.out
    ran = srgc("plan", path)
    assert ran.status == 0
    cells = ran.out.split()
    assert (cells[0], cells[-1]) == ("Gate", "Shed")
    assert not any(cell.startswith("yard") for cell in cells)
    dot = srgc("graph", path, "--of", "workspace").out
    assert "yard.1" in dot
    assert "yard.2" in dot
    assert srgc("plan", yard(image=pgm(wall(gap=False)))).status == 3


def test_unknown_counts_as_an_obstacle(srgc: Run, yard: Callable[..., Path]) -> None:
    pixels = wall()
    pixels[5:10, 19:21] = GREY
    assert srgc("plan", yard(image=pgm(pixels))).status == 3
    # What is brighter than the threshold says is free.
    pixels[5:10, 19:21] = 206
    assert srgc("plan", yard(image=pgm(pixels))).status == 0


def test_a_turned_map_is_rounded_outwards(srgc: Run, yard: Callable[..., Path]) -> None:
    path = yard(YAML.replace("[0, 0, 0]", "[0.3, -0.4, 0.1]"))
    ran = srgc("check", path)
    assert ran.status == 0
    [most] = re.findall(r"rounded outwards by at most (\S+) m\n", ran.out)
    assert 0 < float(most) < 1e-12
    assert "the bounds go on beyond the image" in ran.out
    assert srgc("plan", path).status == 0


def test_every_polygon_is_avoided(srgc: Run, yard: Callable[..., Path]) -> None:
    fence = [[[2, -1], [2.1, -1], [2.1, 3], [3, 3], [3, 3.1], [2, 3.1], [2, -1]]]
    text = SPEC.replace("yard.yaml", "fence.geojson").replace("avoid yard", "avoid fence")
    path = yard(text=text, fence=json.dumps({"type": "Polygon", "coordinates": fence}))
    assert "obstacle `fence`: 2 convex pieces from 1 polygon\n" in srgc("check", path).out
    assert srgc("plan", path).status == 0
    # Up to the upper bound, there is no way round.
    higher = json.dumps({"type": "Polygon", "coordinates": fence}).replace("3.1", "4")
    assert srgc("plan", yard(text=text, fence=higher)).status == 3


def test_a_formula_may_name_a_map(srgc: Run, yard: Callable[..., Path]) -> None:
    text = SPEC.replace("avoid yard with effector;", "satisfy always not yard;")
    ran = srgc("check", yard(text=text))
    assert ran.status == 0
    assert "SRG0609" not in ran.out
    ran = srgc("check", yard(text=text.replace("always not yard", "last[0 s] yard")))
    assert ran.status == 1
    assert "error[SRG0704]: task `Push` contradicts itself" in ran.out


@pytest.mark.parametrize(
    ("old", "new", "code", "said"),
    [
        ("start in Gate", "start in yard", "SRG0203", "`yard` is a map of obstacles, not a place"),
        ("reach Shed", "reach yard", "SRG0203", "`yard` is a map of obstacles, not a place"),
        ("avoid yard", "avoid yrad", "SRG0201", "did you mean `yard`?"),
        ("region Gate", "region yard", "SRG0202", "`yard` is declared twice"),
        ("avoid yard with effector;", "", "SRG0609", "no task avoids obstacle `yard`"),
        ("target Shed box [3.2, 3.8]", "target Shed box [1.95, 2.05]", "SRG0604", "lies wholly"),
        ("target Shed box [3.2, 3.8]", "target Shed box [1.5, 2]", "SRG0607", "lies inside `yard`"),
        ("region Gate box [0.2", "obstacle yard_ box [0.2", "SRG0201", "no region `Gate`"),
        (
            "obstacles from",
            'obstacles from "maps/../maps/yard.yaml"; obstacles from',
            "SRG0202",
            "a map is named after its file: rename one of them",
        ),
    ],
)
def test_names_and_places(
    srgc: Run, yard: Callable[..., Path], old: str, new: str, code: str, said: str
) -> None:
    assert old in SPEC
    ran = srgc("check", yard(text=SPEC.replace(old, new, 1)))
    assert ran.out.count(f"[{code}]") == 1
    assert said in ran.out


def test_an_overlap_is_told_once(srgc: Run, yard: Callable[..., Path]) -> None:
    extra = "region Strip box [0, 4] x [1, 3.9] m;\n  obstacles from"
    pixels = wall()
    pixels[20:30, 5:8] = 0
    path = yard(image=pgm(pixels), text=SPEC.replace("obstacles from", extra))
    ran = srgc("check", path)
    assert ran.status == 0
    assert ran.out.count("SRG0610") == 1
    assert "region `Strip` overlaps obstacle `yard`" in ran.out


def test_a_map_outside_the_bounds(srgc: Run, yard: Callable[..., Path]) -> None:
    ran = srgc("check", yard(YAML.replace("[0, 0, 0]", "[40, 0, 0]")))
    assert ran.status == 0
    assert "warning[SRG0605]: obstacle `yard` lies outside the bounds and has no effect" in ran.out


BAD_YAML = [
    ("free_thresh: 0.196\n", "", "maps/yard.yaml:1:1", "this map has no `free_thresh`"),
    ("negate: 0\n", "", "maps/yard.yaml:1:1", "this map has no `negate`"),
    ("0.1\n", "0\n", "maps/yard.yaml:2:13", "the resolution is not positive"),
    ("0.1\n", ".nan\n", "maps/yard.yaml:2:13", "resolution is not a decimal number"),
    ("0.1\n", "1/10\n", "maps/yard.yaml:2:13", "resolution is not a decimal number"),
    ("[0, 0, 0]", "[0, 0]", "maps/yard.yaml:3:9", "origin is not a list of three numbers"),
    ("[0, 0, 0]", "[0, 0, 90]", "maps/yard.yaml:3:16", "the yaw of origin is more than a turn"),
    ("0.65", "0.1", "maps/yard.yaml:6:14", "free_thresh is greater than occupied_thresh"),
    ("negate: 0", "negate: 0\nnegate: 0", "maps/yard.yaml:5:1", "a second `negate`"),
    ("negate: 0", "negate: &n 0\nx: *n", "maps/yard.yaml:5:4", "an alias in a map"),
    ("negate: 0", "negate: !!python/none 0", "maps/yard.yaml:4:9", "negate has a tag"),
    ("negate: 0", "negate: [0", "maps/yard.yaml:5:16", "this is not YAML"),
    ("image: ", "- 1\nimage: ", "maps/yard.yaml:2:1", "this is not YAML"),
]


@pytest.mark.parametrize(("old", "new", "place", "message"), BAD_YAML)
def test_bad_headers(
    srgc: Run, yard: Callable[..., Path], monkeypatch: pytest.MonkeyPatch,
    old: str, new: str, place: str, message: str,
) -> None:  # fmt: skip
    assert old in YAML
    path = yard(YAML.replace(old, new, 1))
    monkeypatch.chdir(path.parent)
    ran = srgc("check", "spec.srg")
    assert ran.status == 1
    assert ran.out.count("error[") == 1, ran.out
    assert f"{place}: error[SRG0109]: {message}" in ran.out
    assert "note: the map is named here" in ran.out
    for command in ("plan", "synth"):
        ran = srgc(command, "spec.srg")
        assert (ran.status, ran.out) == (5, "")
        assert message in ran.err


@pytest.mark.parametrize(
    ("image", "code", "message"),
    [
        (b"", "SRG0109", "the image is neither PGM (P2, P5) nor PNG"),
        (b"GIF89a", "SRG0109", "the image is neither PGM (P2, P5) nor PNG"),
        (b"P5 40 40 255\n\0", "SRG0109", "the image ends before its last pixel"),
        (b"P2 1 1 255 nan", "SRG0109", "a pixel of the PGM image is not a number"),
        (b"P5 99999 99999 255\n", "SRG0110", "the image has 9,999,800,001 pixels, more than"),
        (b"\x89PNG\r\n\x1a\n" + b"\0" * 40, "SRG0109", "the header of the PNG image is damaged"),
    ],
)
def test_bad_images(
    srgc: Run, yard: Callable[..., Path], monkeypatch: pytest.MonkeyPatch,
    image: bytes, code: str, message: str,
) -> None:  # fmt: skip
    path = yard(image=image)
    monkeypatch.chdir(path.parent)
    ran = srgc("check", "spec.srg")
    assert ran.status == 1
    assert ran.out.count("error[") == 1
    assert f"maps/yard.yaml:1:8: error[{code}]: {message}" in ran.out
    assert "image: yard.pgm\n" in ran.out
    [found] = [e for e in json.loads(srgc("check", "--json", "spec.srg").out) if e["code"] == code]
    assert (found["file"], found["line"], found["column"]) == ("maps/yard.yaml", 1, 8)


def test_noise_is_too_much(srgc: Run, yard: Callable[..., Path]) -> None:
    board = np.where(np.indices((110, 110)).sum(axis=0) % 2, 254, 0)
    ran = srgc("check", yard(YAML.replace("0.1\n", "0.03\n"), pgm(board)))
    assert ran.status == 1
    assert "error[SRG0110]: obstacle `yard` has 6,050 convex pieces within the bounds" in ran.out
    assert "at most 5,000 can be used: take a coarser map, or narrower bounds" in ran.out


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ('{"type": "Point", "coordinates": [1, 1]}', 1, "a Point has no interior"),
        ('{"type": "Polygon",\n"coordinates":\n[[[0, 0], [1, 0], [1, 1]]]}', 3, "at least four"),
        (
            json.dumps({"type": "Polygon", "coordinates": [BIG, CROSSED]}).replace(
                "[[1", "\n\n[[1"
            ),
            3,
            "a ring meets itself at (1.5, 1.5)",
        ),
        ('{"type": "Feature",\n "geometry": {"type": "Sphere"}}', 2, "is not a GeoJSON type"),
    ],
)
def test_bad_polygons(
    srgc: Run, yard: Callable[..., Path], text: str, line: int, message: str
) -> None:
    spec = SPEC.replace("yard.yaml", "yard.geojson")
    ran = srgc("check", yard(text=spec, yard=text))
    assert ran.status == 1
    assert ran.out.count("error[") == 1
    assert f"yard.geojson:{line}:" in ran.out
    assert message in ran.out


def test_a_check_without_maps_loads_no_reader_of_maps(tmp_path: Path) -> None:
    path = tmp_path / "slider.srg"
    path.write_text(SLIDER)
    program = (
        "import sys\nfrom srgc.cli import run\n"
        f"assert run(['check', {str(path)!r}]) == 0\n"
        "assert not {'PIL', 'yaml', 'numpy', 'compiler.workspaces.map_server'} & set(sys.modules)"
    )
    root = Path(__file__).parents[2]
    subprocess.run([sys.executable, "-c", program], cwd=root, check=True, capture_output=True)


@pytest.mark.slow
def test_a_motion_through_the_gap_is_found_and_proved(
    srgc: Run, yard: Callable[..., Path], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    assert srgc("synth", yard(), "-o", out, "--json").status == 0
    copied = sorted(path.relative_to(out).as_posix() for path in (out / "spec").rglob("*.*"))
    assert copied == ["spec/maps/yard.pgm", "spec/maps/yard.yaml", "spec/spec.srg"]
    rows = (out / "trajectory.csv").read_text().splitlines()
    names = rows[0].split(",")
    x, y = names.index("e1_x"), names.index("e1_y")
    tips = [(float(row.split(",")[x]), float(row.split(",")[y])) for row in rows[1:]]
    assert any(3 < b < 3.5 for _, b in tips)
    assert all(not 1.9 < a < 2.1 or 3 < b < 3.5 for a, b in tips)
    assert srgc("verify", out).status == 0
    # The image is a part of what is certified.
    (out / "spec" / "maps" / "yard.pgm").write_bytes(pgm(wall(gap=False)))
    assert srgc("verify", out).status != 0
