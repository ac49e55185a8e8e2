"""YAML files of map_server: exact numbers, and one fault with its place for each mistake."""

from __future__ import annotations

from fractions import Fraction

import pytest

from compiler.workspaces.decimals import decimal
from compiler.workspaces.map_header import TEXT_LIMIT, MapFault, MapHeader, map_header
from grammar_lang.diagnostics.diagnostic import Code

TEXT = """\
image: hall.pgm
resolution: 0.05
origin: [-10.25, 5e-1, 0.1]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


def read(text: str) -> MapHeader:
    return map_header(text, "maps/hall.yaml", "maps/hall.pgm")


def test_numbers_are_those_of_their_decimals() -> None:
    assert read(TEXT) == MapHeader(
        resolution=Fraction(1, 20),
        origin=(Fraction(-41, 4), Fraction(1, 2)),
        yaw=Fraction(1, 10),
        negate=False,
        occupied=Fraction(13, 20),
        free=Fraction(49, 250),
        mode="trinary",
    )


@pytest.mark.parametrize("written", ["0.05", "5e-2", "'0.05'", '"5.0E-2"', "+.05", "0.05 # m"])
def test_ways_to_write_a_number(written: str) -> None:
    assert read(TEXT.replace("0.05", written)).resolution == Fraction(1, 20)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1", Fraction(1)),
        ("-0.10", Fraction(-1, 10)),
        ("1.", Fraction(1)),
        ("1e300", Fraction(10) ** 300),
        ("3.0000000000000000000000000000000001", 3 + Fraction(1, 10**34)),
    ],
)
def test_decimals(text: str, value: Fraction) -> None:
    assert decimal(text) == value


@pytest.mark.parametrize(
    "text",
    ["", ".", "1e301", "1e-301", "9" * 301, ".inf", "nan", "1_000", "0x10", "1/2", "1 ", "١"],
)
def test_no_decimals(text: str) -> None:
    assert decimal(text) is None


def test_modes_truth_and_flow_style() -> None:
    assert read(TEXT + "mode: Scale\n").mode == "scale"
    assert read(TEXT.replace("negate: 0", "negate: true")).negate
    assert read(TEXT.replace("[-10.25, 5e-1, 0.1]", "\n- 1\n- 2\n- 0.0")).origin == (1, 2)
    assert read(TEXT + "comment: [anything, {at: all}]\n") == read(TEXT)
    assert read("--- \n" + TEXT + "...\n") == read(TEXT)


@pytest.mark.parametrize(
    "key", ["negate", "occupied_thresh", "free_thresh", "origin", "resolution"]
)
def test_every_field_is_required(key: str) -> None:
    lines = [line for line in TEXT.splitlines(keepends=True) if not line.startswith(key)]
    with pytest.raises(MapFault, match=f"this map has no `{key}`"):
        read("".join(lines))


def test_a_misspelt_field_is_named() -> None:
    with pytest.raises(MapFault) as caught:
        read(TEXT.replace("occupied_thresh", "occupied_tresh"))
    assert caught.value.hint == "is it `occupied_tresh`?"


@pytest.mark.parametrize(
    ("old", "new", "message", "place"),
    [
        ("0.05", "0", "not positive", "0"),
        ("0.05", "-0.05", "not positive", "-0.05"),
        ("0.05", ".nan", "not a decimal number", ".nan"),
        ("0.05", "[1]", "not a single value", "[1]"),
        ("0.05", "!!python/name:os.system 1", "has a tag", "!!python/name:os.system 1"),
        ("0.05", "!!binary MC4x", "has a tag", "!!binary MC4x"),
        ("0.65", "1.5", "between 0 and 1", "1.5"),
        ("0.196", "-1", "between 0 and 1", "-1"),
        ("0.196", "0.7", "greater than occupied_thresh", "0.7"),
        ("negate: 0", "negate: 2", "neither 0 nor 1", "2"),
        ("[-10.25, 5e-1, 0.1]", "[1, 2]", "three numbers", "[1, 2]"),
        ("[-10.25, 5e-1, 0.1]", "1", "three numbers", "1"),
        ("0.1]", "x]", "not a decimal number", "x"),
        ("0.1]", "90]", "more than a turn", "90"),
        ("hall.pgm", "[hall.pgm]", "not a single value", "[hall.pgm]"),
        ("hall.pgm", "other.pgm", "not the image that was read", "other.pgm"),
        ("negate: 0", "mode: grey\nnegate: 0", "unknown mode", "grey"),
        ("negate: 0", "negate: 0\nnegate: 1", "a second `negate`", "negate"),
        ("negate: 0", "negate: &a 0\nx: *a", "an alias", "*a"),
        ("negate: 0", "negate: 0\n? [1]\n: 2", "not a single value", "[1]"),
    ],
)
def test_mistakes(old: str, new: str, message: str, place: str) -> None:
    text = TEXT.replace(old, new, 1)
    with pytest.raises(MapFault, match=message) as caught:
        read(text)
    assert caught.value.place is not None
    start, end = caught.value.place
    assert text[start:end] == place
    assert caught.value.code is Code.UNREADABLE_REFERENCE
    assert caught.value.hint


def test_a_second_field_is_found_where_it_stands() -> None:
    text = TEXT + "resolution: 1\n"
    with pytest.raises(MapFault) as caught:
        read(text)
    assert caught.value.place is not None
    assert caught.value.place[0] == text.rindex("resolution")


@pytest.mark.parametrize(
    "text",
    [
        "",
        "- image: hall.pgm",
        "image: [",
        "a: b: c",
        "\t",
        TEXT + "---\n" + TEXT,
        TEXT + "x: \x07",
        "{" * 5000,
        "a: " + "[" * 5000,
        "a: &a [*a]",
        "a: &a [x]\nb: &b [*a, *a]\nc: [*b, *b]\n" + TEXT,
        '"\\xff": "\\q"',
        TEXT + 'x: "\\UFFFFFFFF"',
        TEXT + 'x: "\\U00110000"',
        TEXT + "x: !<%FF> 1",
        "%YAML 1." + "9" * 5000 + "\n---\n" + TEXT,
        TEXT + "x: |999999999999\n a",
    ],
)
def test_what_is_no_map(text: str) -> None:
    with pytest.raises(MapFault) as caught:
        read(text)
    assert "\n" not in caught.value.message


def test_a_long_text_is_not_read() -> None:
    with pytest.raises(MapFault, match="more than 65,536") as caught:
        read(TEXT + "#" * TEXT_LIMIT)
    assert caught.value.code is Code.TOO_LARGE
