from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import mpmath
import pytest

from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Severity
from grammar_lang.load import load_text

ROOT = Path(__file__).parents[2]

Check = Callable[[str], list[tuple[str, str]]]
Build = Callable[..., str]

CLAUSES = {
    "robot": "robot G;",
    "workspace": "workspace W;",
    "start": "start in S;",
    "reach": "reach T;",
    "effort": "effort <= 10 N*m;",
    "horizon": "horizon 80 steps of 0.125 s;",
    "more": "",
}


def clauses(**other: str) -> str:
    return f"task P {{ {' '.join(other.get(name, text) for name, text in CLAUSES.items())} }}"


@pytest.fixture(scope="session")
def task(build: Build) -> Callable[..., ir.Task]:
    def make(**other: str) -> ir.Task:
        loaded = load_text(build(task=clauses(**other)), "t")
        assert loaded.program is not None, loaded.diagnostics
        return loaded.program.tasks["P"]

    return make


def test_defaults(task: Callable[..., ir.Task]) -> None:
    assert task() == ir.Task(
        name="P",
        grammar="G",
        workspace="W",
        start=ir.StartIn("S", None, Fraction(0)),
        reach=ir.Reach("T", None),
        avoid=(),
        effort=(ir.Effort("revolute", Fraction(10), norm2=False),),
        steps=80,
        step=Fraction(1, 8),
        slack=Fraction(1, 10**6),
        gravity=(Fraction(0), Fraction(0)),
        modules=None,
        bounds_body=False,
    )


def test_clauses(task: Callable[..., ir.Task]) -> None:
    assert task(start="start in S by effector 2 at rest;").start == ir.StartIn("S", 2, Fraction(0))
    rates = task(start="start in S rates <= 50 rad/s * 0.01;").start
    assert rates == ir.StartIn("S", None, Fraction(1, 2))
    sixth = ir.Binary("*", ir.Num(Fraction(1, 6)), ir.Pi())
    assert task(start="start at (30, 0.5 rad) deg;").start == ir.StartAt(
        (sixth, ir.Num(Fraction(1, 2))), kinds=("revolute", "revolute")
    )
    assert task(start="start at (0);").start == ir.StartAt((ir.Num(Fraction(0)),), kinds=(None,))
    assert task(reach="reach T by effector 3 at rest;").reach == ir.Reach("T", 3, ir.FinalRates())
    avoid = task(more="avoid S, T with body, margin 2 cm; avoid S with effector margin 0;").avoid
    assert avoid == (
        ir.Avoid(("S", "T"), "body", Fraction(1, 50)),
        ir.Avoid(("S",), "effector", Fraction(0)),
    )
    assert task(effort="effort <= 2*3 norm 2;").effort == (
        ir.Effort("revolute", Fraction(6), norm2=True),
    )
    horizon = task(horizon="horizon 3*27 steps of 10/81;")
    assert (horizon.steps, horizon.step, horizon.at_most) == (81, Fraction(10, 81), False)
    more = task(more="slack 1e-3; gravity (0, -981) cm/s^2; modules <= 5; bounds with body;")
    assert more.slack == Fraction(1, 1000)
    assert more.gravity == (Fraction(0), Fraction(-981, 100))
    assert more.modules == 5
    assert more.bounds_body


def test_any_number_of_steps(task: Callable[..., ir.Task]) -> None:
    short = task(horizon="horizon at most 2 + 1 steps of 250 ms;")
    assert (short.steps, short.step, short.at_most) == (3, Fraction(1, 4), True)
    assert short.fewest_steps == 1
    fixed = short.lasting(2)
    assert (fixed.steps, fixed.at_most, fixed.fewest_steps) == (2, False, 2)
    stays = task(horizon="horizon at most 9 steps of 250 ms;", reach="reach T at rest for 1.1 s;")
    assert stays.fewest_steps == 5


@pytest.mark.parametrize(
    ("other", "found"),
    [
        ({"robot": ""}, [("MISSING_CLAUSE", "P")]),
        ({"workspace": ""}, [("MISSING_CLAUSE", "P")]),
        ({"start": ""}, [("MISSING_CLAUSE", "P")]),
        ({"reach": ""}, [("MISSING_CLAUSE", "P")]),
        ({"effort": ""}, [("MISSING_CLAUSE", "P")]),
        ({"horizon": ""}, [("MISSING_CLAUSE", "P")]),
        ({"more": "robot G;"}, [("REPEATED_CLAUSE", "robot G;")]),
        ({"more": "reach S;"}, [("REPEATED_CLAUSE", "reach S;")]),
        ({"more": "start at (0);"}, [("REPEATED_CLAUSE", "start at (0);")]),
        ({"more": "effort <= 1 J;"}, [("REPEATED_CLAUSE", "effort <= 1 J;")]),
        ({"robot": "robot H;"}, [("UNKNOWN_NAME", "H")]),
        ({"workspace": "workspace V;"}, [("UNKNOWN_NAME", "V")]),
        ({"reach": "reach U;"}, [("UNKNOWN_NAME", "U")]),
        ({"more": "avoid U with body;"}, [("UNKNOWN_NAME", "U")]),
        ({"effort": "effort <= 10 N;"}, [("UNIT_MISMATCH", "10 N")]),
        ({"effort": "effort <= 10 kg;"}, [("UNIT_MISMATCH", "10 kg")]),
        ({"effort": "effort <= 0 N*m;"}, [("BAD_VALUE", "0 N*m")]),
        ({"effort": "effort <= 1 N*m norm 3;"}, [("BAD_VALUE", "3")]),
        ({"horizon": "horizon 0 steps of 1 s;"}, [("BAD_VALUE", "0")]),
        ({"horizon": "horizon 1.5 steps of 1 s;"}, [("BAD_VALUE", "1.5")]),
        ({"horizon": "horizon 5 steps of 0 s;"}, [("BAD_VALUE", "0 s")]),
        ({"horizon": "horizon 5 steps of 1 m;"}, [("UNIT_MISMATCH", "1 m")]),
        ({"horizon": "horizon at most 0 steps of 1 s;"}, [("BAD_VALUE", "0")]),
        ({"horizon": "horizon at most 1.5 steps of 1 s;"}, [("BAD_VALUE", "1.5")]),
        (
            {"more": "horizon at most 5 steps of 1 s;"},
            [("REPEATED_CLAUSE", "horizon at most 5 steps of 1 s;")],
        ),
        # An end must fit in the longest of motions.
        ({"horizon": "horizon at most 5 steps of 1 s;", "reach": "reach T at rest for 5 s;"}, []),
        (
            {"horizon": "horizon at most 5 steps of 1 s;", "reach": "reach T at rest for 6 s;"},
            [("BAD_VALUE", "6 s")],
        ),
        ({"reach": "reach T by effector 0;"}, [("BAD_VALUE", "0")]),
        ({"start": "start in S rates <= 1 m/s;"}, [("UNIT_MISMATCH", "1 m/s")]),
        ({"start": "start in S rates <= -1;"}, [("BAD_VALUE", "-1")]),
        ({"start": "start in S rates <= 3 deg/s;"}, [("NOT_RATIONAL", "3 deg/s")]),
        ({"start": "start at (1 m);"}, [("UNIT_MISMATCH", "1 m")]),
        ({"start": "start at (90);"}, [("ANGLE_ABOVE_TURN", "90")]),
        ({"more": "gravity (0, 0, -9.81);"}, [("OUT_OF_PLANE", "(0, 0, -9.81)")]),
        ({"more": "gravity (0, -9.81) m/s;"}, [("UNIT_MISMATCH", "m/s")]),
        ({"more": "modules <= 0;"}, [("BAD_VALUE", "0")]),
        ({"more": "modules >= 3;"}, [("BAD_VALUE", "modules >= 3;")]),
        ({"more": "avoid S with body margin -1 cm;"}, [("BAD_VALUE", "-1 cm")]),
        ({"more": "slack -1;"}, [("BAD_VALUE", "-1")]),
        ({"more": "avoid self with effector;"}, [("BAD_VALUE", "self")]),
        ({"more": "avoid self, S with effector;"}, [("BAD_VALUE", "self")]),
        ({"more": "avoid self with body; avoid self with body;"}, [("REPEATED_CLAUSE", "self")]),
        ({"more": "avoid self, self with body;"}, [("REPEATED_CLAUSE", "self")]),
        ({"more": "avoid self with body margin -1 cm;"}, [("BAD_VALUE", "-1 cm")]),
        ({"more": "avoid self with body, except L K;"}, [("UNKNOWN_NAME", "K")]),
        (
            {"more": "avoid self with body, except S L, L base;"},
            [
                ("WRONG_KIND", "S"),
                ("UNKNOWN_NAME", "base"),
            ],
        ),
        (
            {"more": "avoid self with body except JO JO;"},
            [("BAD_VALUE", "avoid self with body except JO JO;")],
        ),
        ({"more": "avoid S with body, except L L;"}, [("BAD_VALUE", "L")]),
        ({"more": "from B; from B eps JO;"}, [("REPEATED_CLAUSE", "from B eps JO;")]),
        ({"reach": "satisfy S; reach T; reach T;"}, [("REPEATED_CLAUSE", "reach T;")]),
    ],
)
def test_findings(
    other: dict[str, str], found: list[tuple[str, str]], check_fragment: Check, build: Build
) -> None:
    assert check_fragment(build(task=clauses(**other))) == found


@pytest.mark.parametrize(
    ("other", "marked", "message"),
    [
        ({"reach": "reach L;"}, "L", "`L` is a module, not a region of workspace `W`"),
        ({"reach": "reach eps;"}, "eps", "`eps` is an edge, not a region of workspace `W`"),
        ({"reach": "reach G;"}, "G", "`G` is a grammar, not a region of workspace `W`"),
        ({"reach": "reach W;"}, "W", "`W` is a workspace, not a region of workspace `W`"),
        ({"start": "start in P;"}, "P", "`P` is a task, not a region of workspace `W`"),
        ({"more": "avoid N with body;"}, "N", "`N` is a nonterminal, not a region of workspace"),
        ({"robot": "robot W;"}, "W", "`W` is a workspace, not a grammar"),
        ({"robot": "robot S;"}, "S", "`S` is a region of workspace `W`, not a grammar"),
        ({"workspace": "workspace G;"}, "G", "`G` is a grammar, not a workspace"),
        ({"reach": "satisfy eventually JO;"}, "JO", "`JO` is a module, not a region of workspace"),
    ],
)
def test_a_name_of_another_kind(
    other: dict[str, str], marked: str, message: str, build: Build
) -> None:
    loaded = load_text(build(task=clauses(**other)), "t")
    [found] = [d for d in loaded.diagnostics if d.severity is Severity.ERROR]
    assert found.code is Code.WRONG_KIND
    assert found.message.startswith(message)
    assert found.hint
    text = loaded.sources[0].text
    assert text[found.span.start : found.span.end] == marked
    [(declared, _)] = found.notes
    assert text[declared.start : declared.end].split(":")[0] in {marked, "base"}


@pytest.mark.parametrize(
    ("region", "other", "rule", "hint"),
    [
        (
            "region R",
            {"more": "avoid R with body;"},
            "a round place to avoid has to be an `obstacle`",
            "write `obstacle R` where it is declared",
        ),
        (
            "obstacle R",
            {"reach": "reach R;"},
            "a round place to start or end has to be a `region` or `target`",
            "write `region R` where it is declared",
        ),
        (
            "region R",
            {"more": "satisfy eventually R;"},
            "formulas name only places with flat sides",
            "declare it as a box, a polytope or a hull",
        ),
    ],
)
def test_a_round_place_of_the_wrong_kind(
    region: str, other: dict[str, str], rule: str, hint: str, build: Build
) -> None:
    text = build(task=clauses(**other))
    head, kind, rest = text.partition("target T")
    loaded = load_text(f"{head}{region} ball (1, 1) m radius 10 cm;\n{kind}{rest}", "t")
    [found] = [d for d in loaded.diagnostics if d.severity is Severity.ERROR]
    assert found.code is Code.WRONG_KIND
    assert found.message == f"`R` is a round `{region.removesuffix(' R')}`; {rule}"
    assert found.hint == hint


def test_a_region_of_another_workspace(build: Build) -> None:
    workspace = """
workspace W { plane xy; bounds box [0, 5] x [0, 5] m; region S box [0, 1] x [0, 1] m; }
workspace V { plane xy; bounds box [0, 5] x [0, 5] m; region T box [0, 1] x [0, 1] m; }
"""
    loaded = load_text(build(workspace=workspace), "t")
    [found] = [d for d in loaded.diagnostics if d.severity is Severity.ERROR]
    assert found.message == "`T` is a region of workspace `V`, not a region of workspace `W`"


def test_the_robot_itself(task: Callable[..., ir.Task], build: Build) -> None:
    alone = task(more="avoid self with body;")
    assert (alone.avoid, alone.avoid_self) == ((), ir.AvoidSelf(Fraction(0)))
    both = task(more="avoid self, S with body margin 1 cm; avoid T with effector;")
    assert both.avoid_self == ir.AvoidSelf(Fraction(1, 100))
    assert both.avoid == (
        ir.Avoid(("S",), "body", Fraction(1, 100)),
        ir.Avoid(("T",), "effector", Fraction(0)),
    )
    assert task().avoid_self is None


def test_bodies_that_may_touch() -> None:
    text = (ROOT / "specs" / "planar_arm_body.srg").read_text(encoding="utf-8")
    itself = "avoid self, O with body, margin 2 cm, except L L, K L, L K;"
    text = text.replace("avoid O with body margin 0.02 m;", itself)
    text = text.replace("semantics PlanarArm {", "module K { role link; }\nsemantics PlanarArm {")
    text = text.replace("link: N -> N eps L;", "link: N -> N eps L; other: N -> N eps K;")
    block = "other { this.frame = N.frame; point(frame: N.frame, mass: 1 kg); } tool"
    text = text.replace("  tool {", f"  {block} {{")
    loaded = load_text(text, "t")
    assert loaded.program is not None, loaded.diagnostics
    some = loaded.program.tasks["PickAndPlaceWithBody"].avoid_self
    assert some == ir.AvoidSelf(Fraction(1, 50), frozenset({("L", "L"), ("K", "L")}))


def test_a_region_called_self(build: Build) -> None:
    workspace = """
workspace W { plane xy; bounds box [0, 5] x [0, 5] m;
  region S box [0, 1] x [0, 1] m; obstacle self box [2, 3] x [0, 1] m;
  target T box [3, 4] x [3, 4] m; }
"""
    text = build(workspace=workspace, task=clauses(more="avoid self with effector;"))
    loaded = load_text(text, "t")
    assert loaded.program is not None, loaded.diagnostics
    found = loaded.program.tasks["P"]
    assert found.avoid == (ir.Avoid(("self",), "effector", Fraction(0)),)
    assert found.avoid_self is None


@pytest.mark.parametrize(
    ("written", "bound", "duration"),
    [
        ("at rest", Fraction(1, 1000), Fraction(0)),
        ("at rest for 0.3 s", Fraction(1, 1000), Fraction(3, 10)),
        ("rates <= 0.02 rad/s", Fraction(1, 50), Fraction(0)),
        ("rates <= 2 * 0.01 for 300 ms", Fraction(1, 50), Fraction(3, 10)),
        ("rates <= 0.02 rad/s for 10 s", Fraction(1, 50), Fraction(10)),
    ],
)
def test_final_rates(
    task: Callable[..., ir.Task], written: str, bound: Fraction, duration: Fraction
) -> None:
    found = task(reach=f"reach T by effector 2 {written};")
    assert found.reach == ir.Reach("T", 2, ir.FinalRates(bound, bound, duration))
    assert (found.final_rates, found.stay) == (ir.FinalRates(bound, bound, duration), duration)


def test_an_irrational_bound_of_final_rates_is_rounded_both_ways(
    task: Callable[..., ir.Task],
) -> None:
    rates = task(reach="reach T rates <= 2 deg/s;").final_rates
    assert rates is not None
    with mpmath.workdps(50):
        exact = mpmath.pi / 90
        low, high = (mpmath.mpf(x.numerator) / x.denominator for x in (rates.bound, rates.most))
        assert low < exact < high < low * (1 + mpmath.mpf("1e-30"))


@pytest.mark.parametrize(
    ("written", "code", "at"),
    [
        ("rates <= 0", "BAD_VALUE", "0"),
        ("rates <= 0 - 1 deg/s", "BAD_VALUE", "0 - 1 deg/s"),
        ("rates <= 1 m", "UNIT_MISMATCH", "1 m"),
        ("rates <= 1 m/s", "UNIT_MISMATCH", "1 m/s"),
        ("rates <= (1 - sqrt(2)) rad/s", "BAD_VALUE", "(1 - sqrt(2)) rad/s"),
        ("at rest for 0 s", "BAD_VALUE", "0 s"),
        ("at rest for -1 s", "BAD_VALUE", "-1 s"),
        ("at rest for 1 m", "UNIT_MISMATCH", "1 m"),
        ("at rest for 10.001 s", "BAD_VALUE", "10.001 s"),
    ],
)
def test_final_rates_that_make_no_sense(
    check: Check, build: Build, written: str, code: str, at: str
) -> None:
    assert check(build(task=clauses(reach=f"reach T {written};"))) == [(code, at)]


def test_reach_is_optional_beside_a_formula(task: Callable[..., ir.Task]) -> None:
    found = task(reach="satisfy eventually T; satisfy always not S;")
    assert found.reach is None
    assert len(found.satisfy) == 2
    assert task(more="satisfy eventually T;").reach == ir.Reach("T", None)
    with pytest.raises(LookupError, match="task P has no reach clause"):
        _ = found.goal


def test_an_effort_bound_for_every_kind(check: Check, build: Build) -> None:
    grammar = "grammar G { start N; a: N -> SL JO; }"
    semantics = "semantics G { a { effector(frame: move(x, SL.d) * rot(z, JO.q)); } }"
    modules = """
module SL { role joint; dof d: prismatic x; } module JO { role joint; dof q: revolute z; }
"""

    def found(effort: str) -> list[tuple[str, str]]:
        task = clauses(effort=effort)
        return check(build(modules=modules, grammar=grammar, semantics=semantics, task=task))

    assert found("effort <= 1 N*m; effort <= 2 N;") == []
    assert found("effort <= 1 N*m;") == [("MISSING_CLAUSE", "P")]
    assert found("effort <= 1;") == [("UNIT_MISMATCH", "1")]


@pytest.mark.parametrize(
    ("link", "marked"),
    [
        ("this.frame = N.frame * rot(x, 30 deg) * move(x, L.length);", "x"),
        ("this.frame = N.frame * move(-z, L.length);", "-z"),
        ("this.frame = N.frame * move((0, 0, L.length));", "L.length"),
        ("this.frame = N.frame; rod(frame: N.frame, axis: z, length: 1, density: 1);", "z"),
        (
            """this.frame = N.frame;
            solid(frame: N.frame, mass: 1, com: (0, 0), inertia: (1, 1, 1, 0, 0, 0));""",
            "(1, 1, 1, 0, 0, 0)",
        ),
    ],
)
def test_the_plane_is_flat(link: str, marked: str, check_fragment: Check, build: Build) -> None:
    """Such semantics are fine in themselves, and wrong in a task with a plane workspace."""
    semantics = f"""
semantics G {{
  base {{ this.frame = world; }} joint {{ this.frame = N.frame * rot(z, JO.q); }}
  link {{ {link} }} tool {{ this.frame = N.frame; effector(frame: N.frame); }}
}}"""
    assert check_fragment(build(semantics=semantics, task="")) == []
    assert check_fragment(build(semantics=semantics)) == [("OUT_OF_PLANE", marked)]


def test_inertia_in_space_has_six_numbers(check: Check, build: Build) -> None:
    workspace = """
workspace W { space xyz; bounds box [0, 5] x [0, 5] x [0, 5] m;
  region S hull (0, 0, 0); target T hull (1, 1, 1); }"""
    semantics = """
semantics G {
  base { this.frame = world; } joint { this.frame = N.frame * rot(z, JO.q); }
  link { this.frame = N.frame; solid(frame: N.frame, mass: 1, com: (0, 0, 1), inertia: 2); }
  tool { this.frame = N.frame; effector(frame: N.frame); }
}"""
    assert check(build(workspace=workspace, semantics=semantics)) == [("OUT_OF_PLANE", "2")]


def test_a_grammar_without_semantics_is_no_robot(check: Check, build: Build) -> None:
    assert check(build(semantics="")) == [("MISSING_BLOCK", "G")]


MOTOR_SLIDE = """
module B  { role base; }
module JO { role joint; dof q: revolute z in [-180, 180] deg; }
module P  { role joint; dof d: prismatic x in [0, 1] m; input pull in [-1, 1] N; torque(d) = pull; }
module EN { role effector; }
edge eps;
"""


def test_the_unit_of_a_start_is_that_of_its_joint_however_it_is_driven(build: Build) -> None:
    """The slide has an input of its own: no effort bounds it, and all the same it has a length."""
    grammar = """
grammar G { start N; base: N -> B; joint: N -> N eps JO; slide: N -> N eps P; tool: N -> N eps EN; }
"""
    semantics = """
semantics G {
  base { this.frame = world; }
  joint { this.frame = N.frame * rot(z, JO.q); }
  slide { this.frame = N.frame * move(x, P.d); }
  tool { this.frame = N.frame; effector(frame: N.frame); }
}
"""
    text = build(
        modules=MOTOR_SLIDE,
        grammar=grammar,
        semantics=semantics,
        task=clauses(start="start at (10 deg, 0.5 m, 50 cm / 1 m, 0.25);"),
    )
    loaded = load_text(text, "t")
    assert loaded.program is not None, loaded.diagnostics
    start = loaded.program.tasks["P"].start
    assert isinstance(start, ir.StartAt)
    assert start.kinds == ("revolute", "prismatic", "revolute", None)
    marked = [text[place.start : place.end] for place in start.places]
    assert marked == ["10 deg", "0.5 m", "50 cm / 1 m", "0.25"]


def test_the_unit_of_a_start_has_to_be_that_of_some_joint(build: Build) -> None:
    turning = MOTOR_SLIDE.replace("prismatic x in [0, 1] m", "revolute z").replace(" N;", " N*m;")
    for joints in ("JO", "P"):
        grammar = f"grammar G {{ start N; base: N -> B; more: N -> N eps {joints}; }}"
        dof = {"JO": "JO.q", "P": "P.d"}[joints]
        semantics = (
            "semantics G { base { this.frame = world; } "
            f"more {{ this.frame = N.frame * rot(z, {dof}); effector(frame: this.frame); }} }}"
        )
        effort = "effort <= 10 N*m;" if joints == "JO" else ""
        task = clauses(start="start at (0.5 m);", effort=effort)
        text = build(modules=turning, grammar=grammar, semantics=semantics, task=task)
        loaded = load_text(text, "t")
        errors = [d for d in loaded.diagnostics if d.severity is Severity.ERROR]
        assert [d.code for d in errors] == [Code.UNIT_MISMATCH]
