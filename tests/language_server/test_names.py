"""Definition, references and renaming, on a text whose names are marked by hand."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from grammar_lang.diagnostics.diagnostic import Severity
from grammar_lang.load import load
from srgc.language_server.documents.analysis import Analysis, analyse
from srgc.language_server.documents.places import definition, highlights, references
from srgc.language_server.documents.uris import uri_of
from srgc.language_server.edits.rename import RenameRefused, rename

# Every place of a thing is marked <number:name>; the same number is the same thing.
MARKED = """\
module <1:B> { role base; }
module <2:J> { role joint; const <3:k> = 2 N*m*s/rad; dof <4:q>: revolute z in [-2, 2];
  torque(<4:q>) = u - <3:k> * rate(<4:q>); }
module <5:L> { role link; param <6:len> in [1, 2] m; const <7:rho> = 3 kg/m; }
module <8:E> { role effector; }
edge <9:eps>, '<10:[>';
grammar <11:Arm> {
  start <12:N>;
  <13:base>: <12:N> -> <1:B>;
  <14:arm>: <12:N> -> <15:left>:<12:N> <9:eps> <2:J> '<10:[>' <5:L> <9:eps> <5:L>;
  <16:tool>: <12:N> -> <12:N> <9:eps> <8:E>;
  accept contains <8:E> and count(<9:eps>) <= 9 and matches <1:B> (<9:eps> | '<10:[>')*;
}
grammar <17:Other> { start <18:N>; <19:base>: <18:N> -> <1:B>; <20:more>: <18:N> -> <18:N> <9:eps> <8:E>; }
semantics <11:Arm> {
  <13:base> { this.<21:frame> = world; this.<22:mass> = 1 kg; }
  <14:arm> { this.<21:frame> = <15:left>.<21:frame> * rot(z, <2:J>.<4:q>) * move(x, <5:L>1.<6:len>);
    this.<22:mass> = <5:L>2.<6:len> * <5:L>2.<7:rho>;
    rod(frame: <15:left>.<21:frame>, axis: x, length: <5:L>1.<6:len>, density: <5:L>1.<7:rho>); }
  <16:tool> { this.<21:frame> = <12:N>.<21:frame>; this.<22:mass> = <12:N>.<22:mass>;
    point(frame: <12:N>.<21:frame>, mass: <12:N>.<22:mass>); effector(frame: <12:N>.<21:frame>); }
}
semantics <17:Other> {
  <19:base> { this.<30:at> = world; }
  <20:more> { this.<30:at> = <18:N>.<30:at>; effector(frame: <18:N>.<30:at>); }
}
workspace <23:W> { plane xy; bounds box [0, 5] x [0, 5] m;
  region <24:S> box [1, 2] x [1, 2] m; obstacle <25:O> box [3, 4] x [3, 4] m; }
workspace <26:V> { plane xy; bounds box [0, 5] x [0, 5] m; region <27:S> box [1, 2] x [1, 2] m; }
task <28:T> { robot <11:Arm>; workspace <23:W>; start in <24:S> at rest; avoid <25:O> with effector;
  satisfy eventually <24:S> and not <25:O>; effort <= 1 N*m; horizon 4 steps of 1 s;
  from <1:B> <9:eps> <2:J> '<10:[>' <5:L> <9:eps> <5:L> <9:eps> <8:E> fixed <5:L>1.<6:len> = 1 m; }
task <29:U> { robot <17:Other>; workspace <26:V>; start in <27:S>; reach <27:S>;
  effort <= 1 N*m; horizon 4 steps of 1 s; }
module <31:Rod> { role link; param <32:l> in [1, 2] m; port in: <33:F>; port <34:out>: <35:Side> male;
  frame <36:mid> = in * move(x, <32:l>); frame <34:out> = <36:mid> * rot(z, 1 rad); point(frame: <36:mid>, mass: 1 kg); }
module <37:Tip> { role effector; port in: <35:Side> female; effector(frame: in); }
module <38:Foot> { role base; port <39:up>: <33:F>; frame <39:up> = in; }
grammar <40:Kit> from ports { start <38:Foot>; with <31:Rod>, <37:Tip>; accept contains <31:Rod>; }
grammar <41:Hung> { start <42:M>; <43:all>: <42:M> -> <38:Foot> <31:Rod> <37:Tip>; }
semantics <41:Hung> { <43:all> { let <44:f> = <38:Foot>.<39:up>; <38:Foot>.in = world; <31:Rod>.in = <44:f>;
  <37:Tip>.in = <31:Rod>.<34:out>; } }
"""  # noqa: E501
_MARK = re.compile(r"<(\d+):([^>]+)>")


def unmarked() -> tuple[str, list[tuple[int, int, int]]]:
    """The text, and (number, start, end) of every mark."""
    parts: list[str] = []
    marks: list[tuple[int, int, int]] = []
    here = size = 0
    for found in _MARK.finditer(MARKED):
        parts += [MARKED[here : found.start()], found[2]]
        size += found.start() - here
        marks.append((int(found[1]), size, size + len(found[2])))
        size += len(found[2])
        here = found.end()
    return "".join([*parts, MARKED[here:]]), marks


TEXT, MARKS = unmarked()
NUMBERS = sorted({number for number, _, _ in MARKS})
PATH = Path("/nowhere/spec.srg")


@pytest.fixture(scope="module")
def analysis() -> Analysis:
    return analyse(str(PATH), TEXT, {})


def test_the_text_is_sound(analysis: Analysis) -> None:
    """Else the marks would not be what the compiler makes of them."""
    wrong = [d.message for d in analysis.loaded.diagnostics if d.severity is Severity.ERROR]
    assert wrong == []


@pytest.mark.parametrize("number", NUMBERS)
def test_references(analysis: Analysis, number: int) -> None:
    due = [(s, e) for n, s, e in MARKS if n == number]
    for start, end in due:
        for offset in (start, end):
            if any(s <= offset < e for n, s, e in MARKS if n != number):
                continue
            lines = analysis.lines(0)
            found = references([analysis], str(PATH), offset, uri_of, declarations=True)
            spans = [(lines.offset(f.range.start), lines.offset(f.range.end)) for f in found]
            assert spans == due
            assert len(highlights(analysis, 0, offset)) == len(due)
    first = definition(analysis, 0, due[-1][0], uri_of)[0]
    assert analysis.lines(0).offset(first.range.start) in {s for s, _ in due}


@pytest.mark.parametrize("number", NUMBERS)
def test_rename(analysis: Analysis, number: int, tmp_path: Path) -> None:
    """All marks of the thing and nothing else; the new text is as sound as the old one."""
    due = [(s, e) for n, s, e in MARKS if n == number]
    if TEXT[slice(*due[0])] == "frame":
        with pytest.raises(RenameRefused):
            rename([analysis], str(PATH), due[0][0], "this", {}, uri_of)
    edit = rename([analysis], str(PATH), due[-1][0], "Fresh", {}, uri_of)
    assert edit is not None
    assert edit.changes is not None
    ((uri, edits),) = edit.changes.items()
    assert uri == uri_of(PATH)
    lines = analysis.lines(0)
    spans = [(lines.offset(e.range.start), lines.offset(e.range.end)) for e in edits]
    assert spans == due
    text = TEXT
    for start, end in reversed(due):
        text = f"{text[:start]}Fresh{text[end:]}"
    path = tmp_path / "spec.srg"
    path.write_text(text, encoding="utf-8")
    assert not [d for d in load(path).diagnostics if d.severity is Severity.ERROR]


@pytest.mark.parametrize(
    ("number", "name", "said"),
    [
        (5, "J", "`J` is already the name of module `J`"),
        (5, "N", "`N` is already the name of nonterminal `N`"),
        (5, "left", "`left` is already the name of occurrence `left`"),
        (12, "eps", "`eps` is already the name of edge `eps`"),
        (33, "Side", "`Side` is already the name of port type `Side`"),
        (36, "l", "`l` is already the name of `l` of module `Rod`"),
        (44, "this", "`this` is a reserved word"),
        (13, "arm", "`arm` is already the name of production `arm`"),
        (6, "rho", "`rho` is already the name of `rho` of module `L`"),
        (24, "O", "`O` is already the name of region `O`"),
        (28, "U", "`U` is already the name of task `U`"),
        (21, "mass", "`mass` is already the name of attribute `mass` of `N`"),
        (11, "accept", "`accept` is a reserved word"),
        (11, "two words", "`two words` is not a name"),
        (11, "2fast", "`2fast` is not a name"),
        (9, "a b", "an edge has visible characters"),
        (8, "L1", "with the name `L1`"),
        (9, "fixed", "with the name `fixed`"),
    ],
)
def test_refused(analysis: Analysis, number: int, name: str, said: str) -> None:
    start = next(s for n, s, _ in MARKS if n == number)
    with pytest.raises(RenameRefused) as refused:
        rename([analysis], str(PATH), start, name, {}, uri_of)
    assert said in str(refused.value)


def test_an_edge_becomes_quoted(analysis: Analysis) -> None:
    start = next(s for n, s, _ in MARKS if n == 9)
    edit = rename([analysis], str(PATH), start, "->", {}, uri_of)
    assert edit is not None
    assert edit.changes is not None
    assert {each.new_text for each in edit.changes[uri_of(PATH)]} == {"'->'"}
    bracket = next(s for n, s, _ in MARKS if n == 10)
    edit = rename([analysis], str(PATH), bracket, "(", {}, uri_of)
    assert edit is not None
    assert edit.changes is not None
    assert {each.new_text for each in edit.changes[uri_of(PATH)]} == {"("}


def test_names_in_other_scopes_may_be_the_same(analysis: Analysis) -> None:
    """A label of one grammar and a region of one workspace have nothing to do with others."""
    for number, name in ((20, "tool"), (27, "O"), (4, "len")):
        start = next(s for n, s, _ in MARKS if n == number)
        assert rename([analysis], str(PATH), start, name, {}, uri_of) is not None
