"""The canonical form, written by hand beside ugly text; and that nothing else is ever given out."""

from __future__ import annotations

import time

import pytest

from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.formatting import formatter
from grammar_lang.formatting.comments import written
from grammar_lang.formatting.formatter import NotFaithful, canonical
from grammar_lang.formatting.spacing import spacing
from grammar_lang.parsing.parse import parse_tokens


def formatted(text: str) -> str:
    sink = Sink()
    made = canonical(text, sink)
    assert made is not None, sink.found
    return made


def within(place: str, text: str) -> str:
    """The canonical form of one statement, as it stands in an item."""
    made = formatted(f"{place} A {{ // c\n {text} }}")
    *head, end = made.removeprefix(f"{place} A {{  // c\n").split("\n}\n")
    assert end == ""
    return "\n".join(line.removeprefix("  ") for line in "\n}\n".join(head).split("\n"))


# --- spacing ------------------------------------------------------------------------------------

EXPRESSIONS = [
    "a + b - c * d / e",
    "-a - -b + --c * -d",
    "a^2 + a^-2 + -a^b^-c + (a + b)^2",
    "2 N*m",
    "2 N * m",
    "2 N / m * s",
    "2 N ^ 2 + (3) m ^ -k + 2 m^2",
    "rot(z, J.q) * move((1, 2, -3)) + f() + sin(-x)",
    "(1 + 2) mm + f(3) kg/m^2 + (1, 2) m",
    "f(frame: this.at, axis: x, length: N1.length)",
    "rate(q) * u - b * rate(q)",
    "((((1))))",
    "m * s + N1 * N",
    "1e3 + 00.10 m + 2.5E-3",
]
STATEMENTS = [
    ("module", "role base;"),
    ("module", "dof q: revolute z in [-1, 1] deg rate in [-2, 2] rad/s;"),
    ("module", "dof q: prismatic -x;"),
    ("module", "param a in [lo, -hi * 2] m;"),
    ("module", "param a in {1, -2, (3), f(4)} mm;"),
    ("module", "state w rad/s = 0;"),
    ("module", "state N N;"),
    ("module", "input v in [0, 1] V;"),
    ("module", "der(w) = -v - w;"),
    ("module", "torque(q) = (u - b) * rate(q);"),
    ("grammar", "start N;"),
    ("grammar", "a: N -> left:N '[' right:N \"]\" eps;"),
    ("grammar", "a: N -> empty;"),
    ("grammar", "accept contains A B and not starts with B or ends with C;"),
    ("grammar", "accept count(A) <= 3 and (length < 20 or count('[') == -k * 2);"),
    ("grammar", "accept matches (A | B* empty)+ C? ('[' (A)* ']')+;"),
    ("grammar", "accept matches A (B C)* and count(A) >= 2 * k + 3 or matches B+;"),
    ("grammar", "accept (matches A* B) and length <= 2 + k;"),
    ("semantics", "a { }"),
    ("semantics", "a { this.f = N.f * rot(z, J.q); effector(frame: N.f); }"),
    ("workspace", "plane xy;"),
    ("workspace", "space xyz;"),
    ("workspace", "bounds box [0, 5] x [0, 5] m x [1, 2];"),
    ("workspace", "obstacle O polytope { -x <= -1.7; x <= 3; -y <= -2; y <= 3; } m;"),
    ("workspace", "region R polytope { x == 1 };"),
    ("workspace", "target T hull (0, 1) m, (2, 3), (-4, 5, 6) cm;"),
    ("workspace", "obstacles from \"map.yaml\";"),
    ("workspace", "obstacles from \"a.stl\" in mm;"),
    ("workspace", "obstacles from \"a.stl\" in mm at world * move((1, 0) m) * rot(z, 3 deg);"),
    ("workspace", "obstacles from \"a.obj\" at rot(-z, -(3) deg);"),
    ("task", "start in S by effector 1 at rest;"),
    ("task", "start in S rates <= 2 rad/s;"),
    ("task", "start at (1 deg, 2) rad;"),
    ("task", "reach T by effector -n + 1 at rest;"),
    ("task", "reach T at rest for 0.3 s;"),
    ("task", "reach T by effector 2 rates <= v for (d + 1) s;"),
    ("task", "avoid self, O with body, margin 2 cm;"),
    ("task", "avoid O with effector margin (2) cm;"),
    ("task", "avoid self with body, margin 2 cm, except A B, B B;"),
    ("task", "effort <= 10 N*m norm 2;"),
    ("task", "horizon 81 steps of 0.125 s;"),
    ("task", "horizon (80 + 1) steps of (1) s;"),
    ("task", "horizon at most 81 steps of 0.125 s;"),
    ("task", "horizon at most (80 + 1) steps of (1) s;"),
    ("task", "slack 1e-6;"),
    ("task", "gravity (0, -9.81) m/s^2;"),
    ("task", "modules <= 6;"),
    ("task", "bounds with body;"),
    ("task", "from B eps '[' fixed L1.length = 2 m, L2.length = -3 m;"),
    ("task", "robust start 1 mm 2, (3) deg 4;"),
    ("task", "robust effort 0.5 %;"),
    ("task", "robust effort (1 + 1) % of bound;"),
    ("task", "robust mass 3 % of L;"),
    ("task", "robust measure 1 mm, (3) deg 4 mm/s;"),
    ("task", "robust mass 3 %;"),
    ("task", "control open loop;"),
    ("task", "control feedback;"),
    ("task", "repeat;"),
    ("task", "minimize modules;"),
    ("task", "minimize sum(price) within 5 % then modules;"),
    ("task", "minimize mass within (2 + 3) * 2 % then sum(sum) within -k % then effort;"),
    ("task", "satisfy eventually[0 s, 5 s] (A or B by effector 2);"),
    ("task", "satisfy not (not A) and always (A implies next B) until last[1 s] C;"),
    ("mission", "tasks Morning, Noon, tasks;"),
    ("mission", "one robot;"),
    ("mission", "reconfigure;"),
    ("mission", "reconfigure add 2, remove -1 * k, change (1 + 2);"),
    ("mission", "free L.length, M.free;"),
    ("mission", "changes <= 2 * (1 + 3);"),
    ("mission", "minimize changes within 5 % then sum(price);"),
]  # fmt: skip


@pytest.mark.parametrize("text", EXPRESSIONS)
def test_expressions_are_spaced_like_this(text: str) -> None:
    assert within("module", f"const c = {text};") == f"const c = {text};"


@pytest.mark.parametrize(("place", "text"), STATEMENTS)
def test_statements_are_spaced_like_this(place: str, text: str) -> None:
    assert within(place, text) == text


def stretched(text: str) -> str:
    """The text with a line break between all tokens."""
    tokens = parse_tokens(text, Sink())[1]
    return "\n".join(written(tokens).texts)


@pytest.mark.parametrize(("place", "text"), STATEMENTS)
def test_line_breaks_of_the_author_do_not_matter(place: str, text: str) -> None:
    assert formatted(stretched(f"{place} A {{ {text} }}")) == formatted(f"{place} A {{ {text} }}")


SQUEEZED = [
    ("module", "const a=2*b+c^-1-(-d)/e;", "const a = 2 * b + c^-1 - (-d) / e;"),
    ("module", "const a=2N*m+2 N *m+f ( b ,c:2 )m;", "const a = 2 N*m + 2 N * m + f(b, c: 2) m;"),
    ("module", "const a=this . f;", "const a = this.f;"),
    ("module", "const a=2 m ^2;", "const a = 2 m ^ 2;"),
    ("module", "const a=2 m/**/^2;", "const a = 2 m /**/ ^ 2;"),
    ("module", "param a in{1,2}mm;", "param a in {1, 2} mm;"),
    ("module", "dof q:revolute-z in[-1,1]deg;", "dof q: revolute -z in [-1, 1] deg;"),
    ("module", "der (a)=b;torque ( q )=u;", "der(a) = b;\ntorque(q) = u;"),
    ("grammar", "a:N->b :N'['empty_;", "a: N -> b:N '[' empty_;"),
    ("grammar", "accept matches(A|B)*C +;", "accept matches (A | B)* C+;"),
    ("grammar", "accept not(count (A)<=3);", "accept not (count(A) <= 3);"),
    ("semantics", "a{this.f=N.f*rot(z,1);}", "a { this.f = N.f * rot(z, 1); }"),
    ("semantics", "a{}b{}", "a { }\nb { }"),
    ("workspace", "bounds box[0,1]x[0,1]m;", "bounds box [0, 1] x [0, 1] m;"),
    ("workspace", "target T hull(0,1),(2,3)m;", "target T hull (0, 1), (2, 3) m;"),
    ("workspace", "region R polytope{x<=-1;y>=2}m;", "region R polytope { x <= -1; y >= 2 } m;"),
    ("task", "start at(1,2);gravity(0,1);", "start at (1, 2);\ngravity (0, 1);"),
    ("task", "satisfy always[0,1](A);", "satisfy always[0, 1] (A);"),
    ("task", "satisfy last [1] (A)and(not(B));", "satisfy last[1] (A) and (not (B));"),
    ("task", "robust effort 5%;", "robust effort 5 %;"),
    ("task", "robust effort 5%of bound;", "robust effort 5 % of bound;"),
    ("task", "control open\n loop;", "control open loop;"),
    ("task", "minimize sum (a)within 5%then mass;", "minimize sum(a) within 5 % then mass;"),
    ("task", "minimize   time\nthen mass;", "minimize time then mass;"),
    ("task", "horizon at  most\t3\nsteps of 2s;", "horizon at most 3 steps of 2 s;"),
    ("task", "horizon at most(3)steps of(2)s;", "horizon at most (3) steps of (2) s;"),
    ("mission", "tasks A ,B;one\nrobot;", "tasks A, B;\none robot;"),
    (
        "mission",
        "reconfigure add 2,remove(1),change-1;",
        "reconfigure add 2, remove (1), change -1;",
    ),
    ("mission", "free L . a,M.b;changes<=3;", "free L.a, M.b;\nchanges <= 3;"),
]


@pytest.mark.parametrize(("place", "text", "wanted"), SQUEEZED)
def test_squeezed_statements(place: str, text: str, wanted: str) -> None:
    assert within(place, text) == wanted


def test_units_keep_their_meaning() -> None:
    """`2 N*m` is a torque; `2 N * m` is 2 N times the name m; neither ever becomes the other."""
    text = "module A { const a = 2 N*m; const b = 2 N * m; const c = 2 N^2; const d = 2 N ^ 2; }\n"
    assert formatted(text) == text
    tokens = written(parse_tokens(text, Sink())[1])
    units = [t for t, kind in zip(tokens.texts, tokens.kinds, strict=True) if kind == "UNIT"]
    assert units == ["N*m", "N", "N^2", "N"]


def test_keywords_as_names_are_names() -> None:
    text = "module matches { const in = fixed * (rate + 1); const last = count(x) - der(y); }\n"
    assert formatted(text) == text


# --- bodies -------------------------------------------------------------------------------------

UGLY = """

include"modules.srg" ;
/* The parts
   of the robot. */
module L{role link;param length in[0.5,5]m;  // metres
      param radius in {20,25,
        30}mm;
const density=1 kg/m;}
module B{role base;}   module E
{
  role effector;
}
edge eps,'[',
  ']';



edge other;
grammar G{//family
  // the start

  start N;



  base:N->B;   // first
  longer:N->N eps L;// second
  /* both
     arms */ fork:N->l:N'['r:N']';
  accept contains E;

}
semantics G{base{this.frame=world;}

longer{this.frame=N.frame*move(x,L.length);rod(frame:N.frame,axis:x,length:L.length,density:L.density);}
fork{}  // nothing
}
workspace W{plane xy;region R polytope{x<=1; // right
  -x<=0;
  y<=1;-y<=0;}m;}
task T{ }
// the end

"""

CANONICAL = """\
include "modules.srg";

/* The parts
   of the robot. */
module L {
  role link;
  param length in [0.5, 5] m;  // metres
  param radius in {20, 25, 30} mm;
  const density = 1 kg/m;
}

module B { role base; }
module E { role effector; }
edge eps, '[', ']';

edge other;

grammar G {  //family
  // the start

  start N;

  base: N -> B;          // first
  longer: N -> N eps L;  // second
  /* both
     arms */
  fork: N -> l:N '[' r:N ']';
  accept contains E;
}

semantics G {
  base { this.frame = world; }

  longer {
    this.frame = N.frame * move(x, L.length);
    rod(frame: N.frame, axis: x, length: L.length, density: L.density);
  }
  fork { }  // nothing
}

workspace W {
  plane xy;
  region R polytope {
    x <= 1;  // right
    -x <= 0;
    y <= 1;
    -y <= 0;
  } m;
}

task T { }
// the end
"""


def test_a_whole_file() -> None:
    assert formatted(UGLY) == CANONICAL
    assert formatted(CANONICAL) == CANONICAL


@pytest.mark.parametrize("keyword", ["grammar", "semantics", "workspace", "task"])
def test_these_bodies_have_a_statement_a_line(keyword: str) -> None:
    inner = {"grammar": "start N;", "semantics": "a { }", "workspace": "plane xy;"}
    text = inner.get(keyword, "reach T;")
    assert formatted(f"{keyword} A {{{text}}}") == f"{keyword} A {{\n  {text}\n}}\n"
    assert formatted(f"{keyword} A {{\n\n}}") == f"{keyword} A {{ }}\n"


def test_modules_blocks_and_polytopes_are_one_line_up_to_a_hundred_columns() -> None:
    module = "module A {{ role base; const {} = 1; }}\n"
    fits = module.format("a" * (100 - len(module.format("")) + 1))
    assert len(fits) == 101
    assert formatted(fits.replace("; ", ";\n")) == fits
    longer = fits.replace("aaa", "aaaa", 1)
    name = "a" * fits.count("a", 11)
    assert formatted(longer).startswith("module A {\n  role base;\n  const " + name[:20])
    block = "semantics A {{\n  a {{ this.{} = 1; }}\n}}\n"
    fits = block.format("a" * (100 - len("  a { this. = 1; }")))
    assert formatted(fits) == fits
    assert formatted(fits.replace("= 1", "= 10")).count("\n") == 5
    region = "workspace A {{\n  region {} polytope {{ x <= 1; y <= 2 }} m;\n}}\n"
    fits = region.format("a" * (100 - len("  region  polytope { x <= 1; y <= 2 } m;")))
    assert formatted(fits) == fits
    end = " polytope {\n    x <= 1;\n    y <= 23\n  } m;\n}\n"
    assert formatted(fits.replace("2 }", "23 }")).endswith(end)


def test_one_line_items_stand_as_the_author_wants_others_alone() -> None:
    text = "edge a;\nmodule A { }\n\n\n\nedge b; task T { reach R; } edge c;\n// c\nedge d;"
    wanted = (
        "edge a;\nmodule A { }\n\nedge b;\n\ntask T {\n  reach R;\n}\n\nedge c;\n// c\nedge d;\n"
    )
    assert formatted(text) == wanted


# --- comments -----------------------------------------------------------------------------------

COMMENTS = [
    ("", ""),
    ("  \n\n ", ""),
    ("// alone", "// alone\n"),
    ("\n\n/* a */ /* b */\n\n\n// c  \r\n", "/* a */ /* b */\n\n// c\n"),
    ("/* a */edge b;", "/* a */ edge b;\n"),
    ("/* a\n b */edge b;", "/* a\n b */\nedge b;\n"),
    ("edge a; /* b */ edge c;", "edge a;\n/* b */ edge c;\n"),
    ("edge a; /* b */ // c\nedge d;", "edge a;  /* b */ // c\nedge d;\n"),
    ("edge a;/* b */", "edge a;  /* b */\n"),
    ("edge a;// b", "edge a;  // b\n"),
    ("edge/* a */b/* c */,/* d */e/* f */;", "edge /* a */ b /* c */, /* d */ e /* f */;\n"),
    ("edge a, // b\n c;", "edge a,  // b\n    c;\n"),
    ("edge a\n// b\n, c;", "edge a\n    // b\n    , c;\n"),
    ("edge a,\n/* b */ c;", "edge a,\n    /* b */ c;\n"),
    ("edge a, /* b */\n c;", "edge a, /* b */\n    c;\n"),
    ("edge a, /* b\nb */ c;", "edge a, /* b\nb */\n    c;\n"),
    ("module A { /* a */ }", "module A {\n  /* a */\n}\n"),
    ("module A { // a\n }", "module A {  // a\n}\n"),
    ("module A {\n\n // a\n\n }", "module A {\n  // a\n}\n"),
    ("module A { role b; /* a */ }", "module A {\n  role b;  /* a */\n}\n"),
    ("module A { /* a */ role b; }", "module A {\n  /* a */ role b;\n}\n"),
    ("module /* a */ A { role b; }", "module /* a */ A {\n  role b;\n}\n"),
    ("module A // a\n { role b; }", "module A  // a\n    {\n  role b;\n}\n"),
    ("module A { } // a", "module A { }  // a\n"),
    ("edge a;\n// b\nmodule A { // c\n}", "edge a;\n\n// b\nmodule A {  // c\n}\n"),
    ("edge a; // b\nmodule A { // c\n}", "edge a;  // b\n\nmodule A {  // c\n}\n"),
    ("edge a;\n// b\n\nmodule A { // c\n}", "edge a;\n// b\n\nmodule A {  // c\n}\n"),
    ("task T { reach /* a */ R /* b */ at rest; }",
     "task T {\n  reach /* a */ R /* b */ at rest;\n}\n"),
    ("task T { horizon at /* a */ most 3 steps of 2 s; }",
     "task T {\n  horizon at /* a */ most 3 steps of 2 s;\n}\n"),
    ("task T { horizon at // a\nmost 3 steps of 2 s; }",
     "task T {\n  horizon at  // a\n      most 3 steps of 2 s;\n}\n"),
    ("task T { start at (/* a */ 1 /* b */, /* c */ 2 /* d */); }",
     "task T {\n  start at (/* a */ 1 /* b */, /* c */ 2 /* d */);\n}\n"),
    ("workspace W { region R polytope { x <= 1; } /* a */ m; }",
     "workspace W {\n  region R polytope {\n    x <= 1;\n  } /* a */ m;\n}\n"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "wanted"), COMMENTS)
def test_comments_stay_where_they_are(text: str, wanted: str) -> None:
    assert formatted(text) == wanted
    assert formatted(wanted) == wanted


def test_comments_at_the_ends_of_neighbouring_lines_are_aligned() -> None:
    text = """\
task T {  // not one of them
  robot A; // a
  workspace Bench;// b
  start in S;
  reach R;   // c

  horizon 1 steps of 2; // d
  avoid aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa, bbbbbbbbbbbbbbbbbbbbbbbbbbbb with effector; // e
}
"""
    wanted = """\
task T {  // not one of them
  robot A;          // a
  workspace Bench;  // b
  start in S;
  reach R;  // c

  horizon 1 steps of 2;  // d
  avoid aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa, bbbbbbbbbbbbbbbbbbbbbbbbbbbb with effector;  // e
}
"""
    assert formatted(text) == wanted


def test_inner_text_of_comments_is_kept() -> None:
    text = "task T {\n      /* one \t\n\t two\r\n        three */\n  //four*/  \n}\n"
    wanted = "task T {\n  /* one\n\t two\n        three */\n  //four*/\n}\n"
    assert formatted(text) == wanted


# --- long statements ----------------------------------------------------------------------------

BROKEN = [
    """\
edge first_symbol_of_the_list, second_symbol_of_the_list, third_symbol_of_the_list,
    fourth_symbol_of_the_list;
""",
    """\
semantics G {
  link {
    rod(frame: N.frame, axis: x, length: L.length_of_the_tube, density: L.density_of_the_tube,
        radius: L.radius_of_the_tube);
    this.frame = N.frame * rot(z, the_angle_at_the_beginning) * move(x, L.length_of_the_tube)
        * rot(z, the_angle_at_the_end);
  }
}
""",
    """\
grammar G {
  accept contains B eps JO eps L and not (contains JO eps JO or ends with eps JO or length > 20)
      and count(JO) <= 12;
  accept matches B (eps JO eps L | eps L eps JO | eps L eps L eps JO | eps JO eps L eps L)*
      | B (eps L)+ eps EN;
  a_production: Nonterminal -> the_first_symbol the_second_symbol the_third_symbol the_fourth_symbol
      the_fifth_symbol;
}
""",
    """\
task T {
  satisfy eventually[0 s, 5 s] (Dock or Shelf) and always not Pillar and (Dock until Shelf)
      implies next (Dock and Shelf);
  avoid the_first_obstacle, the_second_obstacle, the_third_obstacle with body,
      margin 2 cm + 3 mm + 4 mm;
  from B eps JO eps L eps JO eps L eps JO eps L eps EN eps JO eps JO eps JO
      fixed L1.length = 2 m, L2.length = 3 m;
}
""",
    """\
workspace W {
  bounds polytope {
    the_coefficient_of_x * x + the_coefficient_of_y * y + another_term_of_the_same_inequality
        <= 12 + 3;
    y <= 1;
  } m;
}
""",
]


@pytest.mark.parametrize("text", BROKEN)
def test_long_statements_are_broken_like_this(text: str) -> None:
    assert formatted(text) == text
    assert formatted(stretched(text)) == text


def test_what_cannot_be_broken_is_long() -> None:
    name = "a" * 200
    text = f"edge {name},\n    {name};\n"
    assert formatted(text) == text


# --- line ends ----------------------------------------------------------------------------------


def test_line_ends_and_the_end_of_the_file() -> None:
    assert formatted("edge a;\r\n\r\n\r\nedge b;\t\r\n\r\n") == "edge a;\n\nedge b;\n"
    assert formatted("edge a;") == "edge a;\n"
    assert formatted("edge 'ü°', \"☃\";") == "edge 'ü°', \"☃\";\n"


# --- errors and faults --------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["module {", "edge a", "}", "edge a; /* open", "edge é;", "2;"])
def test_a_text_with_syntax_errors_has_no_canonical_form(text: str) -> None:
    sink = Sink()
    assert canonical(text, sink) is None
    assert sink.has_errors


FAULTS = [
    ("edge a;", "edge b;\n", "other tokens"),
    ("edge a;", "edge 'a';\n", "other tokens"),
    ("edge a; edge b;", "edge a;\n", "other tokens"),
    ("module A{const b=2 N * m;}", "module A { const b = 2 N*m; }\n", "other tokens"),
    ("module A{const b=2 N*m;}", "module A { const b = 2 N * m; }\n", "other tokens"),
    ("edge a; // b", "edge a;\n", "other comments"),
    ("edge a; // b", "edge a;  // c\n", "other comments"),
    ("edge a; // b\nedge c;", "edge /* b */ a; edge c;\n", "other comments"),
    ("edge a; /* b */ /* c */", "edge a;  /* c */ /* b */\n", "other comments"),
    ("edge a;// b\nedge c;", "edge a;  // b edge c;\n", "other tokens"),
    ("edge a;  edge b;", "edge a edge b;\n", "syntax errors"),
]


@pytest.mark.parametrize(("text", "made", "what"), FAULTS)
def test_another_text_is_never_given_out(
    text: str, made: str, what: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(formatter, "lay_out", lambda _: made)
    with pytest.raises(NotFaithful, match=f"the canonical form has {what}"):
        canonical(text, Sink())


def test_other_syntax_is_never_given_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Even with the same tokens: two readings of one text are made to differ."""
    first = parse_tokens("edge a;", Sink())[0]
    readings = iter([first, parse_tokens("edge b;", Sink())[0]])

    def parsed(text: str, sink: Sink) -> object:
        return next(readings), parse_tokens(text, sink)[1]

    monkeypatch.setattr(formatter, "parse_tokens", parsed)
    with pytest.raises(NotFaithful, match="the canonical form has other syntax than"):
        canonical("edge  a;", Sink())


# --- size ---------------------------------------------------------------------------------------

LARGE = {
    "one statement": "edge " + ", ".join(f"a{i}" for i in range(8_000)) + ";",
    "parentheses": "module A { const a = " + "(" * 8_000 + "1" + ")" * 8_000 + "; }",
    "blocks": "semantics A { " + "a { } " * 4_000 + "}",
    "comments": "// a\n" * 50_000,
    "inner comments": "edge a" + "/* b */" * 20_000 + ";",
    "stars": "/*" + "*" * 200_000 + "/",
    "one name": "edge " + "a" * 200_000 + ";",
    "alternatives": "grammar G { accept "
    + " or ".join(["(length < 3 and contains A)"] * 1500)
    + "; }",
}


@pytest.mark.parametrize("name", LARGE)
def test_large_texts(name: str) -> None:
    """A quadratic step would take minutes."""
    begin = time.process_time()
    made = formatted(LARGE[name])
    assert formatted(made) == made
    assert time.process_time() - begin < 8


def test_the_ranks_of_nested_places_are_ordered() -> None:
    kinds = ["edge", *["("] * 1000, "NAME", ",", "NAME", *[")"] * 1000, "and", "NAME", ";"]
    ranks = spacing(kinds).ranks
    assert ranks[kinds.index("and")] < ranks[1003] < ranks[1]
