"""`minimize` in tasks: what it means, and what is reported."""

from __future__ import annotations

from fractions import Fraction

import pytest

from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Diagnostic, Severity, Sink
from grammar_lang.formatting.formatter import canonical
from grammar_lang.load import load_text
from tests.oracles.loaded_modules import loaded_after
from tests.oracles.small_specs import TURNER, replaced

MEMBERS = {
    "B": "const price = 5; const weight = 500 g;",
    "JO": "param price in {7/2, 3}; const weight = 1 kg; const odd = sqrt(2);",
    "L": "const price = 1/3; const weight = 2 kg; const both = price * length;",
    "EN": "const price = 0; const weight = 0 kg;",
    "Spare": "const price = 9; const only = 4;",
}
"""What the modules of the spec have beside their bodies; nothing stands for `Spare`."""


def spec(clause: str, members: dict[str, str] = MEMBERS) -> str:
    """The spec of a turner with a clause in its task and members in its modules."""
    text = replaced(TURNER, "reach T;", f"reach T; {clause}")
    for name, own in members.items():
        if name == "Spare":
            text = f"module Spare {{ role link; {own} }}\n{text}"
        else:
            (line,) = (each for each in text.splitlines() if each.startswith(f"module {name} "))
            text = replaced(text, line, f"{line.removesuffix('}')}{own} }}")
    return text


def read(clause: str, members: dict[str, str] = MEMBERS) -> tuple[ir.Objective, ...]:
    found = load_text(spec(clause, members), "spec.srg")
    assert found.program is not None, found.diagnostics
    return found.program.tasks["Turn"].minimize


def marked(clause: str, members: dict[str, str] = MEMBERS) -> list[tuple[str, str, str]]:
    """Severity and code, message and place of what is found in the objectives."""
    text = spec(clause, members)
    codes = {Code.UNUSED_NAME, Code.UNUSED_SYMBOL, Code.FINITE_LANGUAGE}
    found = [each for each in load_text(text, "spec.srg").diagnostics if each.code not in codes]
    assert all(each.hint for each in found)
    return [(_kind(each), each.message, text[each.span.start : each.span.end]) for each in found]


def _kind(found: Diagnostic) -> str:
    return f"{found.severity.value} {found.code.value}"


def hints(clause: str, members: dict[str, str] = MEMBERS) -> list[str]:
    found = load_text(spec(clause, members), "spec.srg").diagnostics
    return [each.hint or "" for each in found if each.code.value.startswith("SRG07")]


def notes(clause: str, members: dict[str, str] = MEMBERS) -> list[str]:
    text = spec(clause, members)
    found = load_text(text, "spec.srg").diagnostics
    return [text[span.start : span.end] for each in found for span, _ in each.notes]


# --- what it means -----------------------------------------------------------------------------


def test_no_objective_is_none() -> None:
    assert read("") == ()


def test_objectives_stand_in_their_order() -> None:
    found = read("minimize modules within 10 % then mass within 0 % then effort;")
    assert [(each.kind, each.within) for each in found] == [
        ("modules", Fraction(1, 10)),
        ("mass", 0),
        ("effort", 0),
    ]
    assert all((each.attribute, each.amounts, each.unit) == (None, (), "") for each in found)


def test_amounts_are_exact_and_in_the_order_of_the_modules() -> None:
    (found,) = read("minimize sum(price);")
    assert found.kind == "sum"
    assert found.attribute == "price"
    assert found.amounts == (("B", 5), ("JO", None), ("L", Fraction(1, 3)), ("EN", 0))
    assert found.unit == ""


def test_amounts_are_in_si_units() -> None:
    found = read("minimize sum(weight) within (1 + 3/2) % then sum(price);")
    assert found[0].amounts == (("B", Fraction(1, 2)), ("JO", 1), ("L", 2), ("EN", 0))
    assert found[0].unit == "kg"
    assert found[0].within == Fraction(1, 40)
    (length,) = read("minimize sum(length);")
    assert (length.amounts, length.unit) == ((("L", None),), "m")
    (turn,) = read("minimize sum(turn);", {"L": "param turn in [1, 90] deg;"})
    assert (turn.amounts, turn.unit) == ((("L", None),), "rad")


def test_places_of_objectives_and_of_the_clause() -> None:
    text = spec("minimize sum(price) within 5 % then modules;")
    program = load_text(text, "spec.srg").program
    assert program is not None
    task = program.tasks["Turn"]
    shown = [text[each.span.start : each.span.end] for each in task.minimize]
    assert shown == ["sum(price) within 5 %", "modules"]
    at = task.clauses["minimize"]
    assert text[at.start : at.end] == "minimize sum(price) within 5 % then modules;"


def test_words_of_the_clause_are_names_elsewhere() -> None:
    members = {"L": "const minimize = 1; const then = 2; const sum = minimize + then;"}
    found = read("minimize sum(minimize) then sum(then) then sum(sum);", members)
    assert [dict(each.amounts)["L"] for each in found] == [1, 2, 3]


def test_modules_of_a_grammar_from_ports() -> None:
    text = """
    module Foot { role base; const price = 2; port out: Flange; frame out = in; }
    module Rod { role link; const price = 3; port in: Flange; port out: Flange;
      frame out = in * move(x, 1 m); }
    module Saw { role effector; const price = 4; port in: Flange; effector(frame: in); }
    module Lid { role effector; const price = 9; port in: Thread; effector(frame: in); }
    grammar Kit from ports { start Foot; with Rod, Saw; }
    grammar Other from ports { start Foot; with Rod, Saw, Lid; }
    workspace W { plane xy; bounds box [-9, 9] x [-9, 9] m; region A box [0, 1] x [0, 1] m; }
    task Go { robot Kit; workspace W; start in A; reach A; horizon 2 steps of 1 s;
      minimize sum(price); }
    """
    found = load_text(text, "spec.srg")
    assert found.sound is not None, found.diagnostics
    (objective,) = found.sound.tasks["Go"].minimize
    assert objective.amounts == (("Foot", 2), ("Rod", 3), ("Saw", 4))


def test_what_is_summed_up_is_used() -> None:
    members = dict.fromkeys(("B", "JO", "L", "EN"), "const price = 1; const cost = 2;")
    text = spec("minimize sum(price);", members)
    unused = [
        each.message
        for each in load_text(text, "spec.srg").diagnostics
        if each.code is Code.UNUSED_NAME
    ]
    assert len(unused) == len(members)
    assert all("`cost`" in message for message in unused)


def test_the_canonical_text() -> None:
    wanted = "  minimize sum(price) within 5 % then modules;\n"
    odd = "minimize  sum ( price )within 5%then // first\n modules ;"
    text = canonical(spec(odd), Sink())
    assert text is not None
    assert "minimize sum(price) within 5 % then  // first\n" in text
    plain = canonical(spec("minimize  sum ( price )within 5%then\n\n modules ;"), Sink())
    assert plain is not None
    assert wanted in plain
    for each in (text, plain):
        assert canonical(each, Sink()) == each


# --- what is reported --------------------------------------------------------------------------

THERE_ARE = "the objectives are `modules`, `mass`, `time`, `energy`, `effort` and `sum(NAME)`"


@pytest.mark.parametrize(
    ("clause", "place", "message", "hint"),
    [
        ("minimize speed;", "speed", "unknown objective `speed`", THERE_ARE),
        ("minimize sums;", "sums", "unknown objective `sums`", THERE_ARE),
        ("minimize masss(price);", "masss", "unknown objective `masss`", THERE_ARE),
        ("minimize torque;", "torque", "unknown objective `torque`", THERE_ARE),
        (
            "minimize module;",
            "module",
            "unknown objective `module`",
            f"did you mean `modules`? {THERE_ARE}",
        ),
        (
            "minimize summ(price);",
            "summ",
            "unknown objective `summ`",
            f"did you mean `sum`? {THERE_ARE}",
        ),
        (
            "minimize price;",
            "price",
            "unknown objective `price`",
            f"did you mean `sum(price)`? {THERE_ARE}",
        ),
        (
            "minimize sum;",
            "sum",
            "a sum of what?",
            "write `sum(NAME)` with the name of a `const` or `param` of the modules",
        ),
        (
            "minimize mass(price);",
            "price",
            "the objective `mass` takes nothing in brackets",
            f"write `mass` alone; {THERE_ARE}",
        ),
    ],
)
def test_names_that_are_no_objective(clause: str, place: str, message: str, hint: str) -> None:
    assert marked(clause) == [("error SRG0720", message, place)]
    assert hints(clause) == [hint]


def test_attributes_that_no_module_has() -> None:
    message = "no module of the grammar has a `const` or `param` called"
    clause = "minimize sum(prise);"
    assert marked(clause) == [("error SRG0721", f"{message} `prise`", "prise")]
    assert hints(clause) == ["did you mean `price`?"]
    # A module that is not of the grammar, and a degree of freedom, do not count.
    for name in ("only", "q"):
        clause = f"minimize sum({name});"
        assert marked(clause) == [("error SRG0721", f"{message} `{name}`", name)]
    assert "known: `price`, `weight`, `odd`, `length`, `density`, `both`" in hints(clause)


def test_modules_without_the_attribute() -> None:
    clause = "minimize sum(length);"
    message = "modules `B`, `JO`, `EN` have no `length` and count as 0"
    assert marked(clause) == [("warning SRG0722", message, "length")]
    assert hints(clause) == ["write `const length = 0 m;` in each if that is intended"]
    few = {name: MEMBERS[name] for name in ("B", "JO", "L")}
    clause = "minimize sum(price) then modules;"
    assert marked(clause, few) == [
        ("warning SRG0722", "module `EN` has no `price` and counts as 0", "price")
    ]
    assert hints(clause, few) == ["write `const price = 0;` in it if that is intended"]


def test_many_modules_without_the_attribute_are_not_all_listed() -> None:
    extra = "".join(f"module X{n} {{ role link; }}\n" for n in range(9))
    text = extra + spec("minimize sum(price);", {"L": "const price = 1;"})
    for n in range(9):
        text = replaced(
            text, "grammar Turner {\n", f"grammar Turner {{\n  x{n}: N -> N eps X{n};\n"
        )
    found = [d for d in load_text(text, "spec.srg").diagnostics if d.code is Code.AMOUNT_OF_ZERO]
    assert [each.message for each in found] == [
        "modules `X0`, `X1`, `X2`, `X3`, `X4`, `X5`, … have no `price` and count as 0"
    ]


@pytest.mark.parametrize(
    ("own", "place", "message"),
    [
        ("const price = -1/2;", "-1/2", "`price` of module `L` is below zero"),
        ("param price in [-1, 2];", "[-1, 2]", "`price` of module `L` may be below zero"),
        ("param price in {3, -1, 2};", "{3, -1, 2}", "`price` of module `L` may be below zero"),
    ],
)
def test_attributes_below_zero(own: str, place: str, message: str) -> None:
    members = {**MEMBERS, "L": own}
    assert marked("minimize sum(price);", members) == [("error SRG0723", message, place)]
    assert notes("minimize sum(price);", members) == ["sum(price)"]
    for zero in ("const price = 0;", "param price in [0, 2];"):
        assert marked("minimize sum(price);", {**MEMBERS, "L": zero}) == []


def test_a_value_that_two_tasks_sum_up_is_reported_once() -> None:
    members = {**MEMBERS, "L": "const price = -1;", "B": "const price = sqrt(2);"}
    text = spec("minimize sum(price);", members)
    task = text[text.index("task Turn") :]
    text += task.replace("task Turn", "task Again")
    errors = [
        each.code
        for each in load_text(text, "spec.srg").diagnostics
        if each.severity is Severity.ERROR
    ]
    assert errors == [Code.NOT_RATIONAL, Code.NEGATIVE_AMOUNT]


@pytest.mark.parametrize(
    ("clause", "place", "message"),
    [
        ("minimize modules within -1 % then mass;", "-1", "`within` is below zero"),
        (
            "minimize modules within 5 %;",
            "5",
            "no objective follows that could use this allowance",
        ),
        (
            "minimize mass then modules within (1 + 1) %;",
            "(1 + 1)",
            "no objective follows that could use this allowance",
        ),
    ],
)
def test_within_that_makes_no_sense(clause: str, place: str, message: str) -> None:
    ((kind, said, at),) = marked(clause)
    assert (kind, said) == ("error SRG0725", message)
    assert at in place


@pytest.mark.parametrize(
    ("within", "code"), [("1 m", "SRG0301"), ("(1, 2)", "SRG0304"), ("sqrt(2)", "SRG0306")]
)
def test_within_is_a_plain_rational_number(within: str, code: str) -> None:
    ((kind, _, at),) = marked(f"minimize modules within {within} % then mass;")
    assert kind == f"error {code}"
    assert at == within


SHARE = "`within` takes a percentage, as in `within 5 %`"


@pytest.mark.parametrize(
    ("clause", "message", "hint"),
    [
        (
            "minimize modules, mass;",
            "expected `then`, found `,`",
            "write `then`",
        ),
        (
            "minimize sum(price) and mass;",
            "expected `then`, found `and`",
            "write `then`",
        ),
        (
            "minimize modules within 5 % and mass;",
            "expected `then`, found `and`",
            "write `then`",
        ),
        (
            "minimize modules within 5 then mass;",
            "expected `%`, found `then`",
            SHARE,
        ),
        ("minimize modules within 5 kg then mass;", "expected `%`, found `then`", SHARE),
        ("minimize modules within 2 m^2;", "expected `%`, found `;`", SHARE),
        ("robust effort 5 kg;", "expected `%`, found `;`", "write it as in `robust effort 5 %;`"),
        ("minimize;", "expected a name, found `;`", "write it as in `minimize mass then time;`"),
        ("minimise mass;", None, "did you mean `minimize`?"),  # and all clauses
    ],
)
def test_what_cannot_be_read(clause: str, message: str | None, hint: str) -> None:
    found = load_text(spec(clause), "spec.srg").diagnostics
    (error,) = [each for each in found if each.severity is Severity.ERROR]
    assert error.code is Code.SYNTAX
    assert message in {None, error.message}
    assert (error.hint or "").partition(" a task has ")[0] == hint


def test_repeated_objectives_and_clauses() -> None:
    clause = "minimize modules then sum(price) then mass then sum(price);"
    assert marked(clause) == [("error SRG0702", "a second `sum(price)`", "sum(price)")]
    assert notes(clause) == ["sum(price)"]
    assert marked("minimize sum(price) then sum(weight);") == []
    clause = "minimize modules; minimize mass;"
    assert marked(clause) == [("error SRG0702", "a second `minimize`", "minimize mass;")]
    assert notes(clause) == ["minimize modules;"]


def test_units_of_one_attribute() -> None:
    members = {**MEMBERS, "L": "const weight = 5;"}
    clause = "minimize sum(weight);"
    message = "expected a mass (kg) as in module `B`, found a plain number or angle"
    assert marked(clause, members) == [("error SRG0301", message, "5")]
    assert notes(clause, members) == ["500 g", "sum(weight)"]
    members = {**MEMBERS, "L": "param price in [1, 2] m;"}
    message = "expected a plain number or angle as in module `B`, found a length (m)"
    assert marked("minimize sum(price);", members) == [("error SRG0301", message, "[1, 2] m")]


@pytest.mark.parametrize(
    ("own", "code", "place"),
    [
        ("const price = sqrt(2);", "SRG0306", "sqrt(2)"),
        ("const price = 5 deg;", "SRG0306", "5 deg"),
        ("const price = length / 1 m;", "SRG0305", "length / 1 m"),
        ("const price = (1, 2);", "SRG0304", "(1, 2)"),
    ],
)
def test_values_that_are_no_exact_numbers(own: str, code: str, place: str) -> None:
    ((kind, _, at),) = marked("minimize sum(price);", {**MEMBERS, "L": own})
    assert (kind, at) == (f"error {code}", place)


def test_a_value_with_an_error_of_its_own_is_left_alone() -> None:
    ((kind, _, at),) = marked("minimize sum(price);", {**MEMBERS, "L": "const price = none;"})
    assert (kind, at) == ("error SRG0201", "none")


def test_an_attribute_in_a_line_with_a_syntax_error_is_not_missed() -> None:
    members = {**MEMBERS, "L": "const price 5;"}
    found = marked("minimize sum(price);", members)
    assert [kind for kind, _, _ in found] == ["error SRG0104"]


def test_objectives_of_a_robot_that_is_unknown() -> None:
    text = spec("minimize sum(price) then sum(prise);").replace("robot Turner", "robot Other")
    errors = [
        each.code
        for each in load_text(text, "spec.srg").diagnostics
        if each.severity is Severity.ERROR
    ]
    assert errors == [Code.UNKNOWN_NAME]


@pytest.mark.parametrize(
    "value",
    [
        "1/0",
        "sqrt(-1)",
        "tan(pi/2)",
        "1e300 * 1e300",
        "10^9999",
        "sqrt(2)^2 - 2",
        "pi - pi",
        "0 * sqrt(2)",
        "1e-300",
        "world",
        "rot(x, 1)",
    ],
)
def test_odd_values_raise_nothing(value: str) -> None:
    for own in (f"const price = {value};", f"param price in [{value}, 9];"):
        text = spec("minimize sum(price);", {**MEMBERS, "L": own})
        program = load_text(text, "spec.srg").program
        if program is not None:
            (objective,) = program.tasks["Turn"].minimize
            assert dict(objective.amounts)["L"] in {None, 0, Fraction(1, 10**300)}


def test_the_clause_loads_what_reads_it() -> None:
    run = "from srgc.session import check_file; from pathlib import Path; check_file(Path({!r}))"
    loaded = loaded_after(run.format("specs/planar_arm.srg"))
    assert "grammar_lang.elaboration.tasks" in loaded
    lazy = {"grammar_lang.elaboration.objectives", "compiler.checks.objective_checks"}
    assert not lazy & loaded
    assert lazy <= loaded_after(run.format("tests/oracles/complete.srg"))


# --- time ----------------------------------------------------------------------------------------


def timed(horizon: str, clause: str) -> list[tuple[str, str]]:
    """Severity and code, and the place, of what is found of time in a task with a horizon."""
    text = spec(clause)
    (old,) = (line for line in text.splitlines() if "horizon" in line)
    text = text.replace(old[old.index("horizon") : old.index(";", old.index("horizon"))], horizon)
    codes = {Code.FIXED_TIME, Code.TIME_WITHOUT_END}
    found = [each for each in load_text(text, "spec.srg").diagnostics if each.code in codes]
    assert all(each.hint and each.notes for each in found)
    return [(_kind(each), text[each.span.start : each.span.end]) for each in found]


def test_time_where_motions_take_different_times() -> None:
    assert timed("horizon at most 9 steps of 0.1 s", "minimize time then mass;") == []
    (first, second) = read("minimize time within 5 % then effort;")
    assert (first.kind, first.within, second.kind) == ("time", Fraction(1, 20), "effort")


def test_time_where_all_motions_take_the_same() -> None:
    fixed = "horizon 9 steps of 0.1 s"
    warned = ("warning SRG0726", "time within 5 %")
    assert timed(fixed, "minimize mass then time within 5 % then modules;") == [warned]
    assert timed(fixed, "minimize mass then modules;") == []
    # Nothing is said where it is not known what the horizon is.
    assert timed("horizon 9 steps", "minimize time;") == []
    assert timed("horizon at 9 steps of 2 s", "minimize time;") == []


def test_time_of_motions_for_ever() -> None:
    error = [("error SRG0727", "time")]
    for horizon in ("horizon 9 steps of 0.1 s", "horizon at most 9 steps of 0.1 s"):
        assert timed(horizon, "minimize modules then time; repeat;") == error
        assert timed(horizon, "minimize modules; repeat;") == []
        assert timed(horizon, "minimize energy; repeat;") == [("error SRG0727", "energy")]
