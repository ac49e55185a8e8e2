"""First objectives with the same value for infinitely many robots: what is found, and what not."""

from __future__ import annotations

from grammar_lang.diagnostics.diagnostic import Code
from grammar_lang.load import load_text
from srgc.session import check_loaded
from tests.oracles.small_specs import TURNER, replaced

ENDLESS = "infinitely many words of grammar `Turner` have the same"


def spec(clause: str, **prices: str) -> str:
    text = replaced(TURNER, "reach T;", f"reach T; {clause}")
    for name, price in prices.items():
        (line,) = (each for each in text.splitlines() if each.startswith(f"module {name} "))
        text = replaced(text, line, f"{line.removesuffix('}')}{price} }}")
    return text


def found(text: str) -> list[tuple[str, str, str]]:
    """Place, message and hint of each finding."""
    checked = check_loaded(load_text(text, "spec.srg"))
    return [
        (text[each.span.start : each.span.end], each.message, each.hint or "")
        for each in checked.diagnostics
        if each.code is Code.ENDLESS_OBJECTIVE
    ]


def const(price: str) -> str:
    return f"const price = {price};"


ALL = {"B": const("1"), "JO": const("2"), "L": const("1/3"), "EN": const("4")}


def test_modules_that_add_nothing() -> None:
    text = spec("minimize sum(price);", **{**ALL, "JO": const("0")})
    hint = "write `modules <= n;`, or give `price` of `JO` a value above zero"
    assert found(text) == [("sum(price)", f"{ENDLESS} sum of `price`", hint)]
    assert found(replaced(text, "reach T;", "reach T; modules <= 9;")) == []
    # Those that have no such attribute add nothing, either.
    text = spec("minimize sum(price) within 5 % then modules;", B=const("1"), JO=const("2"))
    ((place, _, hint),) = found(text)
    assert place == "sum(price) within 5 %"
    assert "of `L`, `EN` a value" in hint


def test_modules_that_add_something() -> None:
    assert found(spec("minimize sum(price);", **ALL)) == []
    # The base stands once in a robot.
    assert found(spec("minimize sum(price);", **{**ALL, "B": const("0")})) == []


def test_the_least_value_of_a_parameter_counts() -> None:
    for domain, free in [
        ("[0, 2]", True),
        ("[1/9, 2]", False),
        ("{3, 0, 1}", True),
        ("{3, 2}", False),
        ("[0, 20] deg", True),
        ("[1, 20] deg", False),  # irrational in rad
    ]:
        text = spec("minimize sum(price);", **{**ALL, "L": f"param price in {domain};"})
        assert bool(found(text)) == free, domain


def test_the_accept_condition_counts() -> None:
    text = spec("minimize sum(price);", **{**ALL, "JO": const("0")})
    accept = "accept contains EN"
    assert found(replaced(text, accept, f"accept count(JO) <= 3; {accept}")) == []
    assert found(replaced(text, accept, f"accept count(L) <= 3; {accept}")) != []
    # So many modules that add nothing, and as many that add something.
    assert found(replaced(text, accept, f"accept matches B (eps JO eps L)+ eps EN; {accept}")) == []


def test_edges_are_no_modules() -> None:
    text = spec("minimize modules;")
    assert found(text) == []
    text = replaced(text, "  tool:  N -> N eps EN;", "  tool:  N -> N eps EN;\n  idle: N -> N eps;")
    text = replaced(text, "  tool  {", "  idle { this.frame = N.frame; }\n  tool  {")
    hint = "let every cycle of the grammar have a module: edges alone add nothing"
    assert found(text) == [("modules", f"{ENDLESS} number of modules", hint)]


def test_only_sums_and_only_the_first_objective() -> None:
    free = {**ALL, "JO": const("0")}
    for clause in ("mass", "effort", "modules then sum(price)", "mass then sum(price)"):
        assert found(spec(f"minimize {clause};", **free)) == []


def test_a_file_with_other_errors_is_not_judged() -> None:
    text = spec("minimize sum(price);", **{**ALL, "JO": const("0")})
    assert found(f"{text}\ngrammar Turner2 {{ start Nowhere; }}\n") == []


def test_a_family_that_is_too_large_is_passed_over() -> None:
    text = spec("minimize sum(price);", **{**ALL, "JO": const("0")})
    accept = "accept contains EN"
    bound = "accept count(L) <= 2000 and count(JO) <= 2000 and count(EN) <= 2000"
    assert found(replaced(text, accept, f"{bound}; {accept}")) == []
