"""Row 4.2: the initial symbol is a module, and no nonterminal is named to start from."""

from __future__ import annotations

from compiler.words.language import language
from grammar_lang import ir
from srgc.cli import run
from tests.oracles.brute_force_grammar import words_of
from tests.oracles.grammars import ARM_MODULES, ARM_TERMINALS, EVERY, arm, grammar
from tests.oracles.small_specs import TURNER, replaced

AB = ("a", "b")
TEXT = "S -> a T\nT -> b S | b"


def derived_from(start: ir.Symbol, rules: ir.Grammar, most: int) -> set[tuple[str, ...]]:
    """All words of terminals that a symbol derives, by rewriting in every place."""
    seen: set[tuple[ir.Symbol, ...]] = {(start,)}
    todo = [(start,)]
    for form in todo:
        for place, symbol in enumerate(form):
            for rule in rules.productions:
                new = (*form[:place], *rule.right, *form[place + 1 :])
                if rule.left == symbol.name and len(new) <= most and new not in seen:
                    seen.add(new)
                    todo.append(new)
    ends = [form for form in seen if all(s.kind != "nonterminal" for s in form)]
    return {tuple(symbol.name for symbol in form) for form in ends}


def test_from_the_printed_initial_symbol_nothing_is_derived() -> None:
    """I = B is a terminal: no rule has it on its left, so the language is the base alone."""
    rules = arm(EVERY)
    assert derived_from(ir.Symbol("B", "module"), rules, 8) == {("B",)}
    from_start = derived_from(ir.Symbol("N", "nonterminal"), rules, 7)
    assert len(from_start) == 1 + 3 + 9 + 27
    found = language(rules, ARM_TERMINALS, ARM_MODULES)
    assert set(found.words(max_length=7)) == from_start


def test_without_a_start_symbol_the_language_is_not_determined() -> None:
    """The same rules, begun with either nonterminal; both would have I = a."""
    first = grammar(TEXT, AB)
    second = grammar("\n".join(reversed(TEXT.splitlines())), AB)
    assert (first.start, second.start) == ("S", "T")
    assert words_of(first, 4) == {("a", "b"), ("a", "b", "a", "b")}
    assert words_of(second, 4) == {("b",), ("b", "a", "b")}
    for rules in (first, second):
        lang = language(rules, AB, frozenset())
        assert set(lang.words(max_length=4)) == words_of(rules, 4)


def test_a_grammar_says_where_it_starts(tmp_path, capsys) -> None:
    file = tmp_path / "arm.srg"
    file.write_text(replaced(TURNER, "  start N;\n", ""), encoding="utf-8")
    assert run(["check", str(file)]) == 1
    assert "start" in capsys.readouterr().out
