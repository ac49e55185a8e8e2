from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import pytest

from grammar_lang import ir
from grammar_lang.elaboration import emissions
from grammar_lang.elaboration.typecheck import EMISSIONS
from grammar_lang.load import load_text

Check = Callable[[str], list[tuple[str, str]]]

HEAD = """
module B { role base; }
module JO { role joint; dof q: revolute -z; }
module SL { role joint; dof d: prismatic x; }
module L { role link; param length in [1, 2] m; const com = (0.5, 0, 0) m; }
edge e;
"""


def spec(productions: str, blocks: str) -> str:
    return f"{HEAD}grammar G {{ start S; {productions} }} semantics G {{ {blocks} }}"


def blocks(productions: str, text: str) -> dict[str, ir.SemanticBlock]:
    loaded = load_text(spec(productions, text), "t")
    assert loaded.program is not None, loaded.diagnostics
    semantics = loaded.program.grammars["G"].semantics
    assert semantics is not None
    return dict(semantics)


def num(value: str) -> ir.Num:
    return ir.Num(Fraction(value))


def this(name: str) -> ir.AttributeOf:
    return ir.AttributeOf(ir.THIS, name)


def test_inherited_and_synthesized_attributes() -> None:
    found = blocks(
        "a: S -> T e T; b: T -> L;",
        """
        a { T1.frame = this.frame; T2.frame = T1.tip; this.mass = T1.mass + T2.mass + 1; }
        b { this.tip = this.frame * move(x, L.length); this.mass = 2 kg; }
        """,
    )
    assert found["a"].rules == (
        ir.AttributeRule(ir.AttributeOf(0, "frame"), this("frame")),
        ir.AttributeRule(ir.AttributeOf(2, "frame"), ir.AttributeOf(0, "tip")),
        ir.AttributeRule(
            this("mass"),
            ir.Binary(
                "+",
                ir.Binary("+", ir.AttributeOf(0, "mass"), ir.AttributeOf(2, "mass")),
                num("1"),
            ),
        ),
    )


def test_emissions() -> None:
    found = blocks(
        "a: S -> L;",
        """a {
          rod(length: L.length, frame: world, axis: -y, density: 1 kg/m, radius: 2 cm);
          point(frame: world, mass: 500 g);
          solid(frame: world, mass: 1, com: L.com, inertia: 0.1);
          solid(frame: world, mass: 1, com: (1, 2, 3) cm, inertia: (1, 2, 3, 0, 0, 0) kg*m^2);
          effector(frame: move((L.length, 0.1, 0)) * rot(z, 90 deg));
        }""",
    )
    length, world = ir.ParameterOf(0, "length"), ir.World()
    com = ir.Vector(num("1/2"), num("0"), num("0"))
    shift = ir.Shift(ir.Vector(length, num("1/10"), num("0")))
    quarter = ir.Binary("*", num("1/2"), ir.Pi())
    assert found["a"].emissions == (
        ir.Rod(world, "-y", length, num("1"), num("1/50")),
        ir.PointMass(world, num("1/2")),
        ir.Solid(world, num("1"), com, (num("1/10"),)),
        ir.Solid(
            world,
            num("1"),
            ir.Vector(num("1/100"), num("1/50"), num("3/100")),
            tuple(num(v) for v in "123000"),
        ),
        ir.Effector(ir.Compose(shift, ir.Rot("z", quarter))),
    )


def test_shapes() -> None:
    found = blocks(
        "a: S -> L;",
        """a {
          sphere(frame: world, radius: 5 cm);
          capsule(frame: world, axis: -x, length: L.length, radius: 0.1);
          cylinder(radius: L.length, length: 20 cm, axis: y, frame: world);
          box(frame: world, size: (L.length, 20) cm);
          box(frame: world, size: (1 m, 20 cm, 3));
        }""",
    )
    length, world = ir.ParameterOf(0, "length"), ir.World()
    sphere, capsule, cylinder, flat, box = found["a"].emissions
    assert sphere == ir.Shape("sphere", world, None, (num("1/20"),))
    assert capsule == ir.Shape("capsule", world, "-x", (length, num("1/10")))
    assert cylinder == ir.Shape("cylinder", world, "y", (num("1/5"), length))
    assert box == ir.Shape("box", world, None, (num("1"), num("1/5"), num("3")))
    # The unit behind the list is that of bare numbers alone.
    assert flat == ir.Shape("box", world, None, (length, num("1/5")))


@pytest.mark.parametrize(("plane", "size"), [("plane xy", "(1, 2, 3)"), ("space xyz", "(1, 2)")])
def test_edges_of_boxes_fit_the_space(plane: str, size: str) -> None:
    axes = "[0, 9] x [0, 9]" if plane == "plane xy" else "[0, 9] x [0, 9] x [0, 9]"
    edges = 2 if plane == "plane xy" else 3
    text = f"""
    module L {{ role link; }} grammar G {{ start S; a: S -> L; }}
    semantics G {{ a {{ box(frame: world, size: {size} m); effector(frame: world); }} }}
    workspace W {{ {plane}; bounds box {axes} m; region A box {axes} m; target T box {axes} m; }}
    task J {{ robot G; workspace W; start in A; reach T; horizon 5 steps of 1 s; }}
    """
    messages = [each.message for each in load_text(text, "t").diagnostics]
    assert [each for each in messages if "box has" in each] == [
        f"in {'the plane' if edges == 2 else 'space'} a box has {edges} edges"
    ]


def test_steps_rules_and_emissions_know_which_modules_they_mention() -> None:
    """By a coordinate, a parameter or a constant that is folded away, in order of mention."""
    modules = """
    module J { role joint; dof q: revolute z; const arm = 1 m; const off = (1, 2) m; }
    module L { role link; param length in [1, 2] m; const half = 50 cm; }
    edge e; grammar G { start S; p: S -> J e L e left:J e T; t: T -> L; }
    """
    rules = """semantics G { p {
      this.len = 2 * L.half - left.arm + 0 * J1.arm;
      T.at = rot(z, left.q) * move(J1.off) * move(x, T.len + L.half / J1.arm * L.length);
      rod(frame: rot(z, J1.q), axis: x, length: left.arm + L.half, density: 1);
      effector(frame: move(x, L.length));
    } t { this.len = L.half; effector(frame: this.at); } }"""
    loaded = load_text(modules + rules, "t.srg")
    assert loaded.program is not None, loaded.diagnostics
    block = (loaded.program.grammars["G"].semantics or {})["p"]
    assert [rule.mentions for rule in block.rules] == [(2, 4, 0), (4, 0, 2)]
    assert [emission.mentions for emission in block.emissions] == [(4, 2), ()]
    match block.rules[1].value:
        case ir.Compose(ir.Compose(ir.Rot() as first, ir.Shift() as second), ir.Move() as third):
            assert [step.mentions for step in (first, second, third)] == [(4,), (0,), (2, 0)]
        case other:
            pytest.fail(repr(other))
    assert block.rules[0] == ir.AttributeRule(this("len"), num("0"))
    assert hash(third) == hash(ir.Move("x", third.distance))
    assert "mentions" not in repr(third)


def test_named_occurrences_and_dofs() -> None:
    found = blocks(
        "a: S -> left:T JO right:T; b: T -> empty;",
        """
        a { left.frame = rot(-z, JO.q); right.frame = left.out * this.frame; }
        b { this.out = this.frame; }
        """,
    )
    assert found["a"].rules == (
        ir.AttributeRule(ir.AttributeOf(0, "frame"), ir.Rot("-z", ir.DofOf(1, "q"))),
        ir.AttributeRule(
            ir.AttributeOf(2, "frame"), ir.Compose(ir.AttributeOf(0, "out"), this("frame"))
        ),
    )


CHAIN = "a: S -> B; b: S -> S e L;"


@pytest.mark.parametrize(
    ("productions", "text", "found"),
    [
        # Blocks.
        ("a: S -> B;", "", [("MISSING_BLOCK", "G")]),
        ("a: S -> B;", "a { } c { }", [("UNKNOWN_NAME", "c")]),
        ("a: S -> B;", "a { } a { }", [("DUPLICATE_NAME", "a")]),
        # Definitions.
        (CHAIN, "a { this.f = world; } b { }", [("UNDEFINED_ATTRIBUTE", "b")]),
        (CHAIN, "a { this.f = world; } b { this.f = S.g; }", [("UNDEFINED_ATTRIBUTE", "g")]),
        (
            CHAIN,
            "a { this.f = world; this.f = world; } b { this.f = S.f; }",
            [("DOUBLE_ATTRIBUTE", "this.f")],
        ),
        (
            CHAIN,
            "a { this.frame = world; } b { S.frame = world; this.frame = world; }",
            [("DOUBLE_ATTRIBUTE", "S.frame")],
        ),
        (CHAIN, "a { } b { S.height = 1 m; }", [("UNDEFINED_ATTRIBUTE", "S.height")]),
        (CHAIN, "a { effector(frame: this.frame); } b { }", [("UNDEFINED_ATTRIBUTE", "b")]),
        (CHAIN, "a { effector(frame: this.frame); } b { S.frame = world; }", []),
        ("a: S -> B;", "a { B.frame = world; }", [("WRONG_KIND", "B.frame")]),
        ("a: S -> B;", "a { C.frame = world; }", [("UNKNOWN_NAME", "C")]),
        (
            "a: S -> S S; b: S -> B;",
            "a { this.f = S.f; } b { this.f = world; }",
            [("AMBIGUOUS_OCCURRENCE", "S")],
        ),
        # Sorts and dimensions of attributes.
        (CHAIN, "a { this.m = 1 kg; } b { this.m = S.m + 1 m; }", [("UNIT_MISMATCH", "1 m")]),
        (CHAIN, "a { this.m = 1; } b { this.m = S.m + 1 m; }", []),
        (CHAIN, "a { this.m = 1; } b { this.m = world; }", [("SORT_MISMATCH", "1")]),
        (
            CHAIN,
            "a { this.m = 1; } b { this.m = S.m; point(frame: world, mass: S.m); }",
            [("UNIT_MISMATCH", "S.m")],
        ),
        # Degrees of freedom.
        ("a: S -> JO;", "a { }", [("BAD_DOF_USE", "a")]),
        ("a: S -> JO;", "a { this.f = rot(z, JO.q); }", [("BAD_DOF_USE", "JO.q")]),
        ("a: S -> JO;", "a { this.f = move(x, JO.q); }", [("BAD_DOF_USE", "JO.q")]),
        ("a: S -> SL;", "a { this.f = rot(x, SL.d); }", [("BAD_DOF_USE", "SL.d")]),
        ("a: S -> SL;", "a { this.f = move(x, SL.d); }", []),
        ("a: S -> JO;", "a { this.f = rot(-z, 2*JO.q); }", [("BAD_DOF_USE", "JO.q")]),
        ("a: S -> JO;", "a { this.f = rot(-z, (JO.q)); }", []),
        (
            "a: S -> JO;",
            "a { this.f = rot(-z, JO.q) * rot(-z, JO.q); }",
            [("BAD_DOF_USE", "JO.q")],
        ),
        ("a: S -> JO e JO;", "a { this.f = rot(-z, JO1.q); }", [("BAD_DOF_USE", "a")]),
        ("a: S -> JO e JO;", "a { this.f = rot(-z, JO1.q) * rot(-z, JO2.q); }", []),
        # Frames and emissions.
        ("a: S -> B;", "a { this.f = rot(1, 2); }", [("SORT_MISMATCH", "1")]),
        ("a: S -> B;", "a { this.f = rot(z); }", [("SORT_MISMATCH", "rot(z)")]),
        ("a: S -> B;", "a { this.f = rot(z, 90); }", [("ANGLE_ABOVE_TURN", "90")]),
        ("a: S -> B;", "a { this.f = world + world; }", [("SORT_MISMATCH", "world")]),
        ("a: S -> B;", "a { effector(); }", [("BAD_EMISSION", "effector")]),
        ("a: S -> B;", "a { effector(world); }", [("BAD_EMISSION", "world")]),
        ("a: S -> B;", "a { efector(frame: world); }", [("BAD_EMISSION", "efector")]),
        ("a: S -> B;", "a { point(frame: world, mass: -1); }", [("BAD_EMISSION", "-1")]),
        (
            "a: S -> B;",
            "a { point(frame: world, frame: world, mass: 1); }",
            [("BAD_EMISSION", "frame")],
        ),
        (
            "a: S -> B;",
            "a { solid(frame: world, mass: 1, com: (0, 0), inertia: (1, 2)); }",
            [("BAD_EMISSION", "(1, 2)")],
        ),
        ("a: S -> B;", "a { point(frame: world, mass: 1 m); }", [("UNIT_MISMATCH", "1 m")]),
        # Shapes.
        ("a: S -> B;", "a { sphere(frame: world); }", [("BAD_EMISSION", "sphere")]),
        ("a: S -> B;", "a { sphre(frame: world, radius: 1); }", [("BAD_EMISSION", "sphre")]),
        ("a: S -> B;", "a { sphere(frame: world, radius: -1); }", [("BAD_EMISSION", "-1")]),
        ("a: S -> B;", "a { sphere(frame: world, radius: 1 kg); }", [("UNIT_MISMATCH", "1 kg")]),
        ("a: S -> B;", "a { box(frame: world, size: 1 m); }", [("BAD_EMISSION", "1 m")]),
        (
            "a: S -> B;",
            "a { box(frame: world, size: (1, 2, 3, 4) m); }",
            [("BAD_EMISSION", "(1, 2, 3, 4) m")],
        ),
        ("a: S -> B;", "a { box(frame: world, size: (1, -2)); }", [("BAD_EMISSION", "-2")]),
        ("a: S -> B;", "a { box(frame: world, size: (1, 2) kg); }", [("UNIT_MISMATCH", "kg")]),
        (
            "a: S -> B;",
            "a { capsule(frame: world, axis: 1, length: 1, radius: 1); }",
            [("SORT_MISMATCH", "1")],
        ),
        # Cycles.
        (
            "a: S -> B;",
            "a { this.u = this.v + 1; this.v = this.u + 1; }",
            [("CIRCULAR_ATTRIBUTES", "this.u = this.v + 1;")],
        ),
    ],
)
def test_findings(
    productions: str, text: str, found: list[tuple[str, str]], check_fragment: Check
) -> None:
    assert check_fragment(spec(productions, text)) == found


def test_induced_cycles_are_found_and_printed() -> None:
    """Neither production is circular alone: T's s depends on its i, and S feeds s back into i."""
    text = spec(
        "a: S -> T; b: T -> B;", "a { T.i = T.s; this.f = T.s; } b { this.s = this.i + 1 m; }"
    )
    found = load_text(text, "t").diagnostics
    assert [d.code.name for d in found] == ["CIRCULAR_ATTRIBUTES"]
    assert "T.i" in found[0].message
    assert "T.s" in found[0].message


def test_crossing_dependences_are_no_cycle(check_fragment: Check) -> None:
    text = spec(
        "a: S -> T; b: T -> B;",
        "a { T.i = 1 m; T.j = T.s; this.f = T.t; } b { this.s = this.i; this.t = this.j; }",
    )
    assert check_fragment(text) == []


def test_dimensions_flow_against_the_order_of_the_text() -> None:
    found = blocks(
        "a: S -> T; b: T -> U; c: U -> B;",
        """a { this.f = move(x, T.h); } b { this.h = 2 * U.h; } c { this.h = 3 cm; }""",
    )
    assert found["c"].rules[0].value == num("3/100")


def test_attributes_without_a_first_definition_are_refused(check: Check) -> None:
    text = spec("a: S -> B; b: S -> T; c: T -> T e;", "a { } b { } c { this.f = T.f; }")
    assert check(text) == [("UNDEFINED_ATTRIBUTE", "this.f")]


def test_a_rule_with_a_wrong_owner_is_one_error(check_fragment: Check) -> None:
    text = """
module B { role base; } module J { role joint; dof q: revolute z; }
grammar G { start N; b: N -> B; j: N -> N J; }
semantics G {
  b { M.frame = world; }
  j { this.frame = N.frame * rot(z, J.q); effector(frame: N.frame); }
}
"""
    assert check_fragment(text) == [("UNKNOWN_NAME", "M")]


def test_a_wrong_rot_says_nothing_of_its_dof(check_fragment: Check) -> None:
    text = """
module B { role base; } module J { role joint; dof q: revolute z; }
grammar G { start N; b: N -> B J; }
semantics G { b { effector(frame: world * rot(J.q)); } }
"""
    assert check_fragment(text) == [("SORT_MISMATCH", "rot(J.q)")]


def test_bodies_are_no_values_and_values_no_bodies(check_fragment: Check) -> None:
    text = """
module B { role base; }
grammar G { start N; b: N -> B; }
semantics G { b { this.a = rod(frame: world); rot(z, 1); this.c = sine(no); } }
"""
    assert check_fragment(text) == [
        ("SORT_MISMATCH", "rod"),
        ("SORT_MISMATCH", "rot"),
        ("UNKNOWN_NAME", "sine"),
        ("UNKNOWN_NAME", "no"),
    ]


def test_every_emission_is_known_as_one() -> None:
    assert set(EMISSIONS) == set(emissions._ARGUMENTS)


def test_a_long_chain_of_attributes_has_one_type() -> None:
    """From its end back to its beginning, whichever way it is written; bare ones come last."""
    for order in (range(300), range(299, -1, -1)):
        chain = " ".join(f"this.a{i} = this.a{i + 1};" for i in order)
        found = load_text(spec("a: S -> B;", f"a {{ {chain} this.a300 = 2 m; }}"), "t")
        assert found.program is not None
        text = spec("a: S -> B;", f"a {{ {chain} this.a300 = 2; this.w = this.a0 + 1 kg; }}")
        found = load_text(text, "t")
        assert {d.code.name for d in found.diagnostics} == {"UNIT_MISMATCH"}


def test_a_long_cycle_is_printed_by_its_ends(check: Check) -> None:
    chain = " ".join(f"this.a{i} = this.a{(i + 1) % 50} + 0 m;" for i in range(50))
    (found,) = load_text(spec("a: S -> B;", f"a {{ {chain} this.a50 = 1 m; }}"), "t").diagnostics
    assert found.message.count("->") == 7
    assert "-> … 44 more … ->" in found.message


@pytest.mark.parametrize(
    "value", ["m^1e300", "-(m^1e300)", "sqrt(m^1e300)", "tan(m^1e300)", "m^1e300 + 1 kg"]
)
def test_a_huge_power_of_an_unknown_name_is_an_unknown_name(value: str) -> None:
    text = f"a {{ point(frame: world, mass: {value}); }}"
    found = load_text(spec("a: S -> B;", text), "t").diagnostics
    assert "UNKNOWN_NAME" in {d.code.name for d in found}


def test_an_occurrence_is_called_as_in_its_production(check_fragment: Check) -> None:
    text = """
module B { role base; } module J { role joint; dof q: revolute z; }
grammar G { start N; b: N -> B J J; }
semantics G { b { effector(frame: rot(z, J1.q) * rot(z, J1.q)); } }
"""
    sink = load_text(text, "t.srg").diagnostics
    assert [d.message for d in sink] == [
        "production `b` does not use `J2.q`",
        "`J1.q` is used more than once",
    ]
    assert len(check_fragment(text)) == 2


ONE = "a: S -> B T; one: T -> JO L T; end: T -> L;"
TURNED = "this.turned = this.at * rot(-z, JO.q); T.at = this.turned * move(x, L.length);"
LET = "write `let turned = …;`"


@pytest.mark.parametrize(
    ("one", "end", "hinted"),
    [
        (TURNED, "effector(frame: this.at);", True),  # only the production that defines it
        (f"{TURNED} effector(frame: T.turned);", "effector(frame: this.at);", False),  # a parent
        (TURNED, "effector(frame: this.turned);", False),  # the one that lacks it
        ("this.turned = world; T.at = this.at;", "effector(frame: this.at);", False),  # nobody
    ],
)
def test_an_attribute_that_is_read_only_where_it_is_defined_may_be_a_let(
    one: str, end: str, *, hinted: bool
) -> None:
    text = spec(ONE, f"a {{ T.at = world; }} one {{ {one} }} end {{ {end} }}")
    found = [each for each in load_text(text, "t").diagnostics if each.code.value == "SRG0501"]
    (error,) = found
    assert error.message == "production `end` does not define `this.turned`"
    assert str(error.hint).startswith("add `this.turned = …;`")
    assert (LET in str(error.hint)) == hinted
    if hinted:
        mended = text.replace("this.turned =", "let turned =").replace("this.turned *", "turned *")
        assert load_text(mended, "t").program is not None


def test_an_inherited_attribute_that_only_its_parent_reads_may_be_a_let() -> None:
    text = spec(
        "a: S -> T; b: S -> L T; c: T -> L;",
        "a { T.at = world; effector(frame: T.at); } b { effector(frame: world); } c { }",
    )
    (error,) = (e for e in load_text(text, "t").diagnostics if e.code.value == "SRG0501")
    assert (
        error.hint == "add `T.at = …;`; or write `let at = …;` where only that production reads it"
    )
