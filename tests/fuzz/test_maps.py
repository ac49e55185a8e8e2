"""Spoilt maps of obstacles: images, headers and polygons that are used or refused, soon.

A failure prints its number, of which :func:`survive` makes the map again.
"""

from __future__ import annotations

import random
from collections.abc import Callable

import numpy as np
import pytest

from compiler.workspaces.decimals import MAX_DIGITS
from compiler.workspaces.geojson import geojson_pieces
from compiler.workspaces.grey_image import GreyImage, grey_image
from compiler.workspaces.map_header import PIXEL_LIMIT, MapFault, map_header
from compiler.workspaces.map_server import map_server_pieces
from compiler.workspaces.mesh_scene import scene_pieces
from grammar_lang.files.meshes import MeshError
from grammar_lang.files.scenes import scene_of
from grammar_lang.ir import MapImage
from tests.oracles.mesh_files import binary_stl, text_stl, tube
from tests.oracles.png_files import png_of, sound_chunks, spoilt, spoilt_png
from tests.oracles.survival import time_bound

FAST_BLOCKS, FAST = 2, 300
SLOW_BLOCKS, SLOW = 40, 2000


def _listed(words: str) -> tuple[str, ...]:
    return tuple(words.split())


YAML = """\
image: a.pgm
resolution: 0.05
origin: [-1.5, 2e0, 0.1]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
mode: trinary
"""
YAML_PARTS = _listed(
    "1e300 -1e300 1e-300 1e999999999 .inf .nan 0x10 1_000 1:30 ~ null yes - : ? , [ ] { } & * ! "
    '!!int !<x> | > \' " % @ ` # --- ... << \\x00 "\\0" "\\ud800" "\\UFFFFFFFF" %YAML %TAG'
)
GEOJSON = (
    '{"type": "Polygon", "coordinates": [[[0, 0], [4, 0], [4, 3], [0, 3], [0, 0]], [[1, 1], [2, 1],'
    " [1.5, 2], [1, 1]]]}\n"
    '{"type": "FeatureCollection", "features": [{"type": "Feature", "properties": null, "geometry":'
    ' {"type": "MultiPolygon", "coordinates": [[[[0, 0], [1, 0], [0, 1], [0, 0]]]]}}]}'
).splitlines()
JSON_PARTS = _listed(
    "1e999999999 1e300 -1e300 1e-300 NaN Infinity -0 0.1 1e1 true null [ ] { } : , [[]] {} "
    '"a" "\\ud800" "type": "coordinates": "Polygon" "Point"'
)
PGM = (
    b"P5 # made by hand\n3 2\n255\n\x00\x01\x02\xff\xfe\xfd",
    b"P2\n3 2 7\n0 1 2 # first row\n7 6 5\n",
    b"P5 2 1 65535\n\xff\xff\x00\x00",
)
PGM_PARTS = (
    b"P2", b"P5", b"0", b"-1", b"+1", b"9" * 5000, b"0" * 5000 + b"2", b"999999999", b"65536",
    b"1e9", b"0x2", b"#", b"\n", b"#" * 5000, b" " * 5000, b"\0", b"\xff", b"\r", b"\x0b",
)  # fmt: skip


OBJ = b"""\
o a
v 0 0 0
v 2 0 0
v 0 2 0
v 0 0 2
f 1 2 3
f -4/1 2//2 -1
f 1 3 4
f 2 3 4
o b
v 5.5 0 1e0
v 6 0 0
v 6 1 0
v 5 1 \\
0
f 5 6 7 8 # end
"""
MESHES = (
    ("a.obj", OBJ),
    ("a.stl", binary_stl(tube(4))),
    ("a.stl", text_stl(tube(3))),
)
OBJ_PARTS = _listed(
    "v vn vt f o g l p s usemtl curv \\ # / // - 0 -1 1 9 1e999 1e-999 1e11 nan inf 1/0 0x1 1_0 . "
    "\u0661 v_0 'v 1 2 3' f_1_2_3"
)


def cut_and_pasted(chance: random.Random, text: str, parts: tuple[str, ...]) -> str:
    """A text with some of its characters left out, repeated or replaced by something odd."""
    odd = (*parts, "9" * 5000, "[" * 3000, "a" * 5000, "\0", "\ud800", "\n", " ")
    for _ in range(chance.randint(1, 3)):
        start = chance.randint(0, len(text))
        end = min(len(text), start + chance.choice((0, 0, 1, 5, 30)))
        put = chance.choice((chance.choice(odd), "", text[start:end] * 2))
        text = f"{text[:start]}{put}{text[end:]}"
    return text


def _sound_image(found: GreyImage) -> None:
    assert 0 < found.values.size <= PIXEL_LIMIT
    assert int(found.values.max()) <= found.white < 2**16
    assert found.opaque is None or found.opaque.shape == found.values.shape


def png_survives(chance: random.Random) -> None:
    _sound_image(grey_image(spoilt_png(chance)))


def pgm_survives(chance: random.Random) -> None:
    data = chance.choice(PGM)
    for _ in range(chance.randint(0, 2)):
        start = chance.randint(0, len(data))
        end = chance.choice((start, start, start + 1, start + 4))
        data = data[:start] + chance.choice(PGM_PARTS) + data[end:]
    _sound_image(grey_image(data if chance.random() < 0.5 else spoilt(chance, data)))


def yaml_survives(chance: random.Random) -> None:
    text = cut_and_pasted(chance, YAML, YAML_PARTS)
    header = map_header(text, "a.yaml", "a.pgm")
    assert 0 < header.resolution <= 10**MAX_DIGITS
    assert map_server_pieces(text, "a.yaml", MapImage("a.pgm", PGM[0])).polygons


def geojson_survives(chance: random.Random) -> None:
    text = cut_and_pasted(chance, chance.choice(GEOJSON), JSON_PARTS)
    for piece in geojson_pieces(text).polygons:
        assert len(piece) >= 3
        assert all(abs(x) <= 10**MAX_DIGITS for corner in piece for x in corner)


def mesh_survives(chance: random.Random) -> None:
    name, data = chance.choice(MESHES)
    if name == "a.obj":
        data = cut_and_pasted(chance, data.decode(), OBJ_PARTS).encode("utf-8", "replace")
    else:
        data = spoilt(chance, data)
    try:
        scene = scene_of(name, data)
    except MeshError as error:
        raise MapFault(str(error), "as the language says it") from error
    for piece in scene_pieces(scene).polytopes:
        assert piece.is_bounded
        assert piece.has_interior


STAGES: tuple[Callable[[random.Random], None], ...] = (
    png_survives,
    png_survives,
    pgm_survives,
    yaml_survives,
    geojson_survives,
    mesh_survives,
)


def survive(number: int) -> bool:
    """The map of that number; whether it could be used."""
    try:
        with time_bound():
            STAGES[number % len(STAGES)](random.Random(number))
    except MapFault as fault:
        if not fault.hint or fault.message.endswith("."):
            raise AssertionError(f"map {number}: {fault.message!r}") from fault
        return False
    except Exception as error:
        raise AssertionError(f"map {number}: {error!r}") from error
    return True


@pytest.mark.parametrize("block", range(FAST_BLOCKS))
def test_spoilt_maps(block: int) -> None:
    used = [survive(number) for number in range(FAST * block, FAST * (block + 1))]
    assert 0.02 < np.mean(used) < 0.8


@pytest.mark.slow
@pytest.mark.parametrize("block", range(SLOW_BLOCKS))
def test_many_spoilt_maps(block: int) -> None:
    for number in range(10**6 + SLOW * block, 10**6 + SLOW * (block + 1)):
        survive(number)


def test_the_images_to_start_from() -> None:
    for seed in range(200):
        _sound_image(grey_image(png_of(sound_chunks(random.Random(seed)))))
