from __future__ import annotations

import json
import re

from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.render import to_json, to_text
from grammar_lang.load import load_text
from grammar_lang.source import Source, Span


def test_text_marks_the_place(arm: str) -> None:
    loaded = load_text(arm.replace("[0.5, 5] m", "[5, 0.5] m"), "arm.srg")
    assert to_text(loaded.diagnostics, loaded.sources) == (
        "arm.srg:3:39: error[SRG0303]: "
        "this interval is empty: its lower bound exceeds its upper bound\n"
        "    3 | module L { role link; param length in [5, 0.5] m; const density = 1 kg/m; }\n"
        "      |                                       ^^^^^^^^^^\n"
        "  hint: swap the bounds\n"
    )


def test_json_has_the_fields_of_the_contract(arm: str) -> None:
    loaded = load_text(arm.replace("[0.5, 5] m", "[5, 0.5] m"), "arm.srg")
    assert json.loads(to_json(loaded.diagnostics, loaded.sources)) == [
        {
            "code": "SRG0303",
            "severity": "error",
            "message": "this interval is empty: its lower bound exceeds its upper bound",
            "file": "arm.srg",
            "line": 3,
            "column": 39,
            "end_line": 3,
            "end_column": 49,
            "hint": "swap the bounds",
        }
    ]
    assert to_json((), ()) == "[]\n"


def test_tabs_notes_warnings_and_colour() -> None:
    source = Source("a", "\tab\ncd\x1b\n")
    sink = Sink()
    sink.warning(Code.UNUSED_SYMBOL, "w", Span(2, 9), None, [(Span(4, 5), "n")])
    plain = to_text(sink.sorted(), [source])
    assert plain == (
        "a:1:3: warning[SRG0403]: w\n"
        "    1 | \tab\n"
        "      | \t ^\n"
        "a:2:1: note: n\n"
        "    2 | cd\N{REPLACEMENT CHARACTER}\n"
        "      | ^\n"
    )
    assert "\x1b" not in plain
    assert "\x1b[1;33mwarning[SRG0403]\x1b[0m" in to_text(sink.sorted(), [source], colour=True)


def test_a_place_without_text_has_a_caret_but_an_empty_file_no_excerpt() -> None:
    sink = Sink()
    sink.error(Code.EMPTY_FILE, "nothing", Span(1, 1), "write")
    assert to_text(sink.sorted(), [Source("a", "\n")]) == (
        "a:2:1: error[SRG0105]: nothing\n    2 | \n      | ^\n  hint: write\n"
    )
    sink = Sink()
    sink.error(Code.EMPTY_FILE, "nothing", Span(0, 0), "write")
    assert to_text(sink.sorted(), [Source("a", "")]) == (
        "a:1:1: error[SRG0105]: nothing\n  hint: write\n"
    )


def test_of_a_long_line_the_part_about_the_caret_is_shown() -> None:
    text = "edge " + ", ".join(f"e{i}" for i in range(2000)) + ", 'a b', " + "f" * 2000 + ";"
    loaded = load_text(text, "t.srg")
    (line, carets) = to_text(loaded.diagnostics, loaded.sources).splitlines()[1:3]
    assert len(line) < 200
    assert line[8] == line[-1] == "…"
    assert line[carets.index("^") : carets.rindex("^") + 1] == "'a b'"


def test_of_many_findings_the_foremost_are_shown_in_their_order() -> None:
    source, sink = Source("a", "x" * 60), Sink()
    for place in range(50):
        sink.warning(Code.UNUSED_SYMBOL, f"w{place}", Span(place, place + 1), "h")
    sink.error(Code.SYNTAX, "wrong", Span(55, 56), "h")
    text = to_text(sink.sorted(), [source], most=3)
    assert re.findall(r": (\w+)\[.*: (\w+)$", text, re.M) == [
        ("warning", "w0"),
        ("warning", "w1"),
        ("error", "wrong"),
    ]
    assert text.endswith("\nand 48 more; `srgc check --json` prints them all\n")
    assert "more;" not in to_text(sink.sorted(), [source], most=51)
    assert len(json.loads(to_json(sink.sorted(), [source]))) == 51


def test_control_characters_of_names_are_not_printed() -> None:
    text = "edge 'a\rb', 'c\x1b[31m';"
    loaded = load_text(text, "t.srg")
    assert [d.span.start for d in loaded.diagnostics] == [5, 12]
    sink = Sink()
    sink.error(Code.UNKNOWN_NAME, "unknown `a\r\x1b[2J`", Span(0, 1), "known: `b\n`")
    shown = to_text([*loaded.diagnostics, *sink.found], loaded.sources)
    assert shown.replace("\n", "").isprintable()
    assert len(shown.splitlines()) == 12
    (record,) = json.loads(to_json(sink.found, loaded.sources))
    assert record["message"].isprintable()
    assert record["hint"].isprintable()


def test_long_names_are_cut_short() -> None:
    name = "a" * 1000
    sink = Sink()
    sink.error(Code.UNKNOWN_NAME, f"unknown name `{name}`", Span(0, 1), f"known: `b`, `{name}`")
    text = to_text(sink.sorted(), [Source("a", name)])
    (record,) = json.loads(to_json(sink.sorted(), [Source("a", name)]))
    for shown in (text, record["message"], record["hint"]):
        assert f"`{name[:60]}…`" in shown
        assert name[:100] not in shown.replace(text.splitlines()[1], "")
    assert record["hint"].startswith("known: `b`, `aaa")
