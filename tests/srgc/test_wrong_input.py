"""The wrong inputs a user makes first: one message each, with place, caret and hint."""

from __future__ import annotations

import json
import re

import pytest

PLACE = re.compile(r"^\S+:(\d+):(\d+): error\[SRG\d{4}\]: .+", re.MULTILINE)
ELSEWHERE = [["words"], ["accepts"], ["graph", "--of", "workspace"], ["plan"], ["synth"]]


# name: what is altered, what must be marked (None: nothing to mark), a word of the message
WRONG = {
    "empty file": (lambda text: "", None, "nothing"),
    "only comments": (lambda text: "// nothing\n", None, "nothing"),
    "syntax error": (lambda text: text.replace("start N;", "start N"), "", "expected"),
    "unclosed brace": (lambda text: text.rstrip()[:-1], None, ""),
    "stray character": (lambda text: text.replace("edge eps;", "edge eps; §"), "§", ""),
    "unknown module in a production": (
        lambda text: text.replace("link: N -> N eps L;", "link: N -> N eps Link;"),
        "Link", "Link",
    ),
    "attribute never defined": (
        lambda text: text.replace("base { this.frame = world; }", "base { }"), None, "frame",
    ),
    "wrong unit": (lambda text: text.replace("[0.5, 5] m;", "[0.5, 5] kg;"), None, "length"),
    "a mass where a length is expected": (
        lambda text: text.replace("L.length, density: L", "3 kg, density: L"), "3 kg", "length",
    ),
    "start inside an obstacle": (
        lambda text: text.replace(
            "region S box [0.8, 1.2] x [1.0, 1.4]", "region S box [2, 2.5] x [2.2, 2.7]"
        ), None, "`O`",
    ),
    "target outside the bounds": (
        lambda text: text.replace("target T box [3.5, 4.2] x", "target T box [6, 7] x"),
        None, "outside",
    ),
    "empty interval": (lambda text: text.replace("[0.5, 5]", "[5, 0.5]"), "[5, 0.5] m", "empty"),
    "a construct not yet supported": (
        lambda text: text.replace("reach T;", "satisfy eventually T;"), None, "",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_one_message_with_place_caret_and_hint(srgc, spec, arm_file, name):
    change, marked, word = WRONG[name]
    original = arm_file.read_text(encoding="utf-8")
    text = change(original)
    assert text != original
    path = spec(text)
    ran = srgc("check", path)
    assert (ran.status, ran.err) == (1, "")
    assert ran.out.count("error[") == 1, ran.out
    assert PLACE.search(ran.out)
    assert word in ran.out
    assert ran.out.count("hint: ") == 1
    caret = re.search(r"^ +\| +\^+$", ran.out, re.MULTILINE)
    assert (caret is not None) == bool(text)  # an empty file has nothing to point at
    (record,) = json.loads(srgc("check", path, "--json").out)
    line = (text.splitlines() or [""])[record["line"] - 1]
    if marked is not None:
        assert line[record["column"] - 1 : record["end_column"] - 1] == marked


@pytest.mark.parametrize("name", WRONG)
def test_the_other_commands_say_the_same_and_end_with_5(srgc, spec, arm_file, name, tmp_path):
    path = spec(WRONG[name][0](arm_file.read_text(encoding="utf-8")))
    *findings, counted = srgc("check", path).out.splitlines(keepends=True)
    assert re.match(r"1 file: \d+ error", counted)
    for command in ELSEWHERE:
        ran = srgc(*command, path)
        assert (ran.status, ran.out) == (5, "")
        assert ran.err == "".join(findings)
    assert [item.name for item in tmp_path.iterdir()] == ["spec.srg"]


@pytest.mark.parametrize(
    "content", [b"\xff\xfe\x00", b"\x00" * 100, bytes(range(256)), b"\xef\xbb\xbf", b"(" * 5000]
)
def test_garbage_is_one_message(srgc, spec, content):
    ran = srgc("check", spec(content))
    assert ran.status == 1
    assert ran.out.count("error[") >= 1
    assert "hint: " in ran.out
