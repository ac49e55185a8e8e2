from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import pytest

from grammar_lang import ir
from grammar_lang.diagnostics.render import records
from grammar_lang.load import Loaded, load, load_text

F = Fraction


def num(value: str) -> ir.Num:
    return ir.Num(F(value))


def box(x: tuple[str, str], y: tuple[str, str]) -> ir.Inequalities:
    return ir.Inequalities(
        (
            ir.HalfSpace((F(-1), F(0)), -F(x[0])),
            ir.HalfSpace((F(1), F(0)), F(x[1])),
            ir.HalfSpace((F(0), F(-1)), -F(y[0])),
            ir.HalfSpace((F(0), F(1)), F(y[1])),
        )
    )


def test_the_running_example(arm: str) -> None:
    """Every value from the text of the contract, by hand."""
    loaded = load_text(arm, "planar_arm.srg")
    assert loaded.diagnostics == ()
    program = loaded.program
    assert program is not None
    turn = ir.Interval(ir.Binary("*", num("-1"), ir.Pi()), ir.Pi())
    assert program.modules == {
        "B": ir.Module("B", "base", (), ()),
        "JO": ir.Module("JO", "joint", (), (ir.Dof("q", "revolute", "z", turn, None),)),
        "L": ir.Module(
            "L", "link", (ir.Parameter("length", ir.Interval(num("1/2"), num("5")), "m"),), ()
        ),
        "EN": ir.Module("EN", "effector", (), ()),
    }
    assert program.terminals == ("B", "JO", "L", "EN", "eps")

    grammar = program.grammars["PlanarArm"]
    n, eps = ir.Symbol("N", "nonterminal"), ir.Symbol("eps", "edge")
    assert (grammar.start, grammar.nonterminals) == ("N", ("N",))
    assert grammar.productions == (
        ir.Production("base", "N", (ir.Symbol("B", "module"),)),
        ir.Production("joint", "N", (n, eps, ir.Symbol("JO", "module"))),
        ir.Production("link", "N", (n, eps, ir.Symbol("L", "module"))),
        ir.Production("tool", "N", (n, eps, ir.Symbol("EN", "module"))),
    )
    assert grammar.accept == ir.AllOf((ir.Contains(("EN",)), ir.StartsWith(("B", "eps", "JO"))))
    this, before = ir.AttributeOf(ir.THIS, "frame"), ir.AttributeOf(0, "frame")
    length = ir.ParameterOf(2, "length")

    def rule(value: ir.Expr) -> tuple[ir.AttributeRule, ...]:
        return (ir.AttributeRule(this, value),)

    assert grammar.semantics == {
        "base": ir.SemanticBlock(rule(ir.World()), ()),
        "joint": ir.SemanticBlock(rule(ir.Compose(before, ir.Rot("z", ir.DofOf(2, "q")))), ()),
        "link": ir.SemanticBlock(
            rule(ir.Compose(before, ir.Move("x", length))),
            (ir.Rod(before, "x", length, num("1"), None),),
        ),
        "tool": ir.SemanticBlock(rule(before), (ir.Effector(before),)),
    }
    assert program.workspaces["Bench"] == ir.Workspace(
        "Bench",
        2,
        ir.Region("bounds", "bounds", box(("0", "5"), ("0", "5"))),
        (
            ir.Region("S", "region", box(("0.8", "1.2"), ("1", "1.4"))),
            ir.Region("O", "obstacle", box(("1.7", "3"), ("2", "3"))),
            ir.Region("T", "target", box(("3.5", "4.2"), ("3.8", "4.5"))),
        ),
    )
    assert program.tasks["PickAndPlace"] == ir.Task(
        name="PickAndPlace",
        grammar="PlanarArm",
        workspace="Bench",
        start=ir.StartIn("S", None, F(0)),
        reach=ir.Reach("T", None),
        avoid=(ir.Avoid(("O",), "effector", F(0)),),
        effort=(ir.Effort("revolute", F(10), norm2=False),),
        steps=81,
        step=F(1, 8),
        slack=F(1, 10**6),
        gravity=(F(0), F(0)),
        modules=None,
        bounds_body=False,
    )


def only(loaded: Loaded) -> tuple[str, int, int]:
    """Code, line and column of the one diagnostic, which is an error with a hint."""
    assert loaded.program is None
    (record,) = records(loaded.diagnostics, loaded.sources)
    assert record["severity"] == "error"
    assert record["hint"]
    code, line, column = record["code"], record["line"], record["column"]
    assert isinstance(code, str)
    assert isinstance(line, int)
    assert isinstance(column, int)
    return code, line, column


def test_unreadable_files(tmp_path: Path) -> None:
    assert only(load(tmp_path / "none.srg")) == ("SRG0101", 1, 1)
    assert only(load(tmp_path)) == ("SRG0101", 1, 1)
    assert only(load(Path("a\0b"))) == ("SRG0101", 1, 1)
    os.mkfifo(tmp_path / "pipe")
    assert only(load(tmp_path / "pipe")) == ("SRG0101", 1, 1)
    (tmp_path / "link").symlink_to("link")
    assert only(load(tmp_path / "link")) == ("SRG0101", 1, 1)


@pytest.mark.parametrize(
    ("data", "found"),
    [
        (b"", ("SRG0105", 1, 1)),
        (b" \n// only a comment\n/* and\nanother */", ("SRG0105", 1, 1)),
        (b"\xef\xbb\xbf", ("SRG0105", 1, 1)),
        (b"edge eps;\nedge \xff;", ("SRG0102", 2, 6)),
        (b"\xef\xbb\xbfedge eps;\nedge \xff;", ("SRG0102", 2, 6)),
        (b"edge eps;\r\nedge\0;", ("SRG0103", 2, 5)),
        (b"\xef\xbb\xbfedge eps;\r\nedge ;", ("SRG0104", 2, 6)),
    ],
)
def test_bad_files(data: bytes, found: tuple[str, int, int], tmp_path: Path) -> None:
    path = tmp_path / "a.srg"
    path.write_bytes(data)
    assert only(load(path)) == found


def test_many_comments_before_the_first_item() -> None:
    """Deciding whether a text declares anything takes no time that doubles with each comment."""
    comments = "/**/ // x\n" * 2000
    assert only(load_text(comments, "t")) == ("SRG0105", 1, 1)
    assert load_text(comments + "edge eps;", "t").program is not None


def test_byte_order_mark_and_line_ends_do_not_matter(arm: str, tmp_path: Path) -> None:
    path = tmp_path / "a.srg"
    path.write_bytes(b"\xef\xbb\xbf" + arm.replace("\n", "\r\n").encode())
    loaded = load(path)
    assert loaded.program == load_text(arm, "t").program
    assert loaded.program is not None


@pytest.mark.parametrize(
    ("old", "new", "found"),
    [
        ("role base;", "role base", ("SRG0104", 1, 21)),
        ("N eps JO;", "N eps JX;", ("SRG0201", 10, 21)),
        ("N.frame * rot", "N.fram * rot", ("SRG0501", 18, 26)),
        ("tool { this.frame = N.frame;", "tool {", ("SRG0501", 23, 3)),
        ("[0, 5] x [0, 5] m", "[0, 5] x [0, 5] kg", ("SRG0301", 28, 30)),
        ("[0.5, 5] m", "[0.5, 5] kg", ("SRG0301", 20, 36)),
        ("0.125 s", "0.125 kg", ("SRG0301", 41, 23)),
        ("[0.5, 5] m", "[5, 0.5] m", ("SRG0303", 3, 39)),
        ("robot PlanarArm", "robot PlanarAm", ("SRG0201", 35, 9)),
    ],
)
def test_one_mistake_gives_one_error(
    old: str, new: str, found: tuple[str, int, int], arm: str
) -> None:
    assert old in arm
    assert only(load_text(arm.replace(old, new, 1), "t.srg")) == found


def test_several_mistakes_are_reported_in_order(arm: str) -> None:
    text = arm.replace("role base", "role bsae").replace("reach T", "reach TT")
    loaded = load_text(text, "t.srg")
    places = [(r["line"], r["column"]) for r in records(loaded.diagnostics, loaded.sources)]
    assert places == [(1, 17), (38, 9)]


def test_loading_needs_no_heavy_library() -> None:
    program = (
        "import sys, grammar_lang.load, grammar_lang.diagnostics.render;"
        "print([m for m in ('numpy', 'scipy', 'casadi', 'networkx', 'z3', 'flint', 'click')"
        " if m in sys.modules])"
    )
    root = Path(__file__).parents[2]
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=root, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"


def test_sources_are_kept(build: Callable[..., str]) -> None:
    loaded = load_text(build(), "name.srg")
    assert loaded.program is not None
    assert loaded.program.sources == loaded.sources
    assert loaded.sources[0].name == "name.srg"


def test_a_file_is_kept_byte_for_byte(tmp_path: Path) -> None:
    data = b"\xef\xbb\xbfedge eps;\r\n"
    path = tmp_path / "a.srg"
    path.write_bytes(data)
    (source,) = load(path).sources
    assert (source.path, source.data, source.text) == ("a.srg", data, "edge eps;\r\n")


def test_a_return_alone_ends_a_line(tmp_path: Path) -> None:
    file = tmp_path / "old.srg"
    file.write_bytes(b"// a comment\rmodule A { role bas; }\r\nmodule C { role bas; }\r")
    loaded = load(file)
    places = [loaded.sources[0].position(d.span.start) for d in loaded.diagnostics]
    assert places == [(2, 17), (3, 17)]
