"""Names that nothing uses: each is said once, and nothing is said of what is used somewhere."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grammar_lang.diagnostics.diagnostic import Severity
from grammar_lang.load import load, load_text

Check = Callable[[str], list[tuple[str, str]]]
Build = Callable[..., str]
MODULES = """
module B { role base; } module JO { role joint; dof q: revolute z; }
module L { role link; param length in [0.5, 5] m; } module EN { role effector; } edge eps;
"""
SPECS = sorted((Path(__file__).parents[2] / "specs").glob("*.srg"))


def described(link: str, read: str = "") -> str:
    """A grammar whose semantics describes the module M, and reads these members of it."""
    points = "".join(f"point(frame: world, mass: M.{name});" for name in read.split())
    return f"""
module M {{ role joint; dof q: revolute z; {link} }}
grammar G {{ start S; a: S -> M; }}
semantics G {{ a {{ {points} effector(frame: rot(z, M.q)); }} }}"""


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.stem)
def test_the_specs_are_free_of_warnings(spec: Path) -> None:
    assert load(spec).diagnostics == ()


@pytest.mark.parametrize(
    ("body", "read", "unused"),
    [
        ("", "", ""),
        ("param a in [1, 2] kg; const b = 2 kg;", "a b", ""),
        ("param a in [1, 2] kg; const b = 2 kg;", "a", "b"),
        ("param a in [1, 2] kg; const b = 2 kg;", "b", "a"),
        ("param a in [1, 2] kg; const b = 2 * a;", "b", ""),
        ("const b = 2 kg; param a in [b, 2 * b];", "a", ""),
        ("const b = 2 kg; param a in {b, 2 * b};", "a", ""),
        ("param a in [1, 2] kg; const b = 2 * a;", "", "a b"),
        ("const a = 1; const b = a; const c = b;", "", "a b c"),
        ("const m = 1; dof p: revolute y in [0, m];", "", ""),
        ("const m = 1 rad/s; dof p: revolute y rate in [0, m];", "", ""),
        # Its own dynamics.
        ("param b in [1, 2] N*m*s; torque(q) = u - b * rate(q);", "", ""),
        ("state s; der(s) = 1;", "", "s"),
        ("state s; der(s) = -s / (1 s);", "", "s"),
        ("state s N*m; der(s) = -s / (1 s); torque(q) = s;", "", ""),
        ("state s; state t N*m; der(s) = 1; der(t) = s * (1 N*m/s); torque(q) = t;", "", ""),
        ("state s; state t; der(s) = t / (1 s); der(t) = s / (1 s);", "", "s t"),
        ("input v in [0, 1] N*m; torque(q) = u + v;", "", ""),
        ("input v in [0, 1] N*m; torque(q) = u;", "", "v"),
        ("const k = 1 N*m; input v in [0, k]; torque(q) = v;", "", ""),
        ("const k = 1 N*m; state s N*m = k; der(s) = 0; torque(q) = s;", "", ""),
        ("input v in [0, 1]; state s; der(s) = v / (1 s);", "", "v s"),
    ],
)
def test_members_of_modules(body: str, read: str, unused: str, check: Check) -> None:
    text = described(body, read)
    if "dof p" in body:
        text = text.replace("rot(z, M.q)", "rot(z, M.q) * rot(y, M.p)")
    assert check(text) == [("UNUSED_NAME", name) for name in unused.split()]


def test_what_the_warning_says() -> None:
    found = load_text(described("param a in [1, 2] kg; const b = 2 * a;"), "t").diagnostics
    assert [d.severity for d in found] == [Severity.WARNING] * 2
    assert [d.message for d in found] == [
        "the parameter `a` of module `M` is never used",
        "the constant `b` of module `M` is never used",
    ]
    assert [d.hint for d in found] == [
        "only `b` reads it, which is not used either",
        "read `M.b` in the semantics, or remove it",
    ]


@pytest.mark.parametrize(
    ("rules", "unused"),
    [
        ("a { this.f = world; } b { this.f = S.f; }", ""),
        ("a { this.f = world; } b { this.f = S.f; effector(frame: this.f); }", ""),
        ("a { this.f = world; this.g = 1; } b { this.f = S.f; this.g = 2; }", "g"),
        ("a { } b { S.frame = world; }", "frame"),
        ("a { effector(frame: this.frame); } b { S.frame = world; }", ""),
        ("a { this.f = world; } b { this.f = world; effector(frame: move(x, 1) * S.f); }", ""),
        ("a { this.f = 1; this.g = this.f; } b { this.f = 1; this.g = sin(-(this.f + 1)); }", "g"),
    ],
)
def test_attributes(rules: str, unused: str, check: Check) -> None:
    text = f"""module B {{ role base; }} edge e;
grammar G {{ start S; a: S -> B; b: S -> S e B; }} semantics G {{ {rules} }}"""
    assert check(text) == [("UNUSED_NAME", name) for name in unused.split()]


def test_an_attribute_belongs_to_its_nonterminal(check: Check) -> None:
    """Reading ``f`` of T says nothing about ``f`` of S; the first definition is marked."""
    text = """module B { role base; } edge e;
grammar G { start S; a: S -> left:T e right:T; b: T -> B; c: S -> e; }
semantics G { a { this.f = left.f; effector(frame: right.f); } b { this.f = world; }
  c { this.f = world; } }"""
    [found] = load_text(text, "t").diagnostics
    assert found.message == "the attribute `f` of `S` is never read"
    assert found.span.start == text.index("f = left.f")


@pytest.mark.parametrize(
    ("more", "unused"),
    [
        ("grammar H { start S; a: S -> B; }", ["H"]),
        ("workspace V { plane xy; bounds box [0, 1] x [0, 1]; }", ["V"]),
        ("workspace V { plane xy; bounds hull (0, 0); region R hull (0, 0); }", ["V"]),
    ],
)
def test_what_no_task_names(more: str, unused: list[str], check: Check, build: Build) -> None:
    assert check(build(modules=MODULES) + more) == [("UNUSED_NAME", name) for name in unused]
    assert check(build(modules=MODULES, task="") + more) == []


REGIONS = """
workspace W { plane xy; bounds box [0, 5] x [0, 5] m;
  region S box [0, 1] x [0, 1] m; target T box [3, 4] x [3, 4] m;
  region R box [2, 3] x [0, 1] m; obstacle O box [2, 3] x [4, 5] m; target U box [4, 5] x [4, 5] m;
}"""


@pytest.mark.parametrize(
    ("clause", "unused"),
    [
        ("", "R U"),
        ("avoid R, O with effector;", "U"),
        ("satisfy always (not R or next eventually U);", ""),
        ("satisfy last[1 s] (R until (R implies U));", ""),
    ],
)
def test_regions(clause: str, unused: str, check: Check, build: Build) -> None:
    task = f"""
task P {{ robot G; workspace W; start in S; reach T; {clause} effort <= 10 N*m;
  horizon 80 steps of 0.125 s; }}"""
    found = check(build(modules=MODULES, workspace=REGIONS, task=task))
    assert [name for code, name in found if code == "UNUSED_NAME"] == unused.split()


def test_a_library_uses_nothing(check: Check, build: Build) -> None:
    """Modules, grammars and workspaces to be included."""
    assert check(build(semantics="", task="", grammar="", workspace="")) == []
    assert check(build(semantics="", task="")) == []
    assert check(build(semantics="", task="", modules="", grammar="")) == []


def test_an_included_file_is_a_library(tmp_path: Path, build: Build) -> None:
    """What it declares need not be used; what the main file declares need be."""
    library = "module L { role link; param length in [1, 2] m; const a = 1; }"
    library += "workspace V { plane xy; bounds hull (0, 0); }"
    (tmp_path / "library.srg").write_text(library, encoding="utf-8")
    modules = re.sub("module L .*?}", "", MODULES)
    main = tmp_path / "main.srg"
    text = "include 'library.srg';" + build(modules=modules)
    main.write_text(text.replace("region S", "region R box [0, 1] x [0, 1]; region S"), "utf-8")
    assert [(d.code.name, d.message) for d in load(main).diagnostics] == [
        ("UNUSED_NAME", "the region `R` is not named in any task")
    ]


def test_modules_that_no_grammar_uses_are_another_matter(check: Check) -> None:
    """SRG0403 says that of the whole module."""
    assert check(described("") + " module L { role link; const a = 1; }") == []


@pytest.mark.parametrize("mistake", ["edge e, e;", "module N { role jont; }"])
def test_silent_after_errors(mistake: str, check: Check) -> None:
    assert len(check(described("const a = 1;") + mistake)) == 1


def test_silent_after_syntax_errors(check: Check) -> None:
    found = check(described("const a = 1 kg;").replace("effector(", "point(mass: M.a); effector(("))
    assert "UNUSED_NAME" not in [code for code, _ in found]


@given(
    st.lists(st.tuples(st.sets(st.integers(0, 7)), st.booleans()), min_size=1, max_size=8),
)
def test_exactly_what_the_semantics_does_not_reach(made: list[tuple[set[int], bool]]) -> None:
    """Constants made of earlier ones; by brute force, used is what some read one is made of."""
    lines, used = [], set()
    for n, (parts, _) in enumerate(made):
        terms = "".join(f" + c{m}" for m in sorted(parts) if m < n)
        lines.append(f"const c{n} = 1 kg{terms};")
    for n, (_, read) in enumerate(made):
        reached = {n} if read else set()
        for m in range(n, -1, -1):
            if m in reached:
                reached |= {p for p in made[m][0] if p < m}
        used |= reached
    names = " ".join(f"c{n}" for n, (_, read) in enumerate(made) if read)
    found = load_text(described("".join(lines), names), "t").diagnostics
    unused = [f"`c{n}`" for n in range(len(made)) if n not in used]
    assert [d.message.split()[2] for d in found] == unused
