from __future__ import annotations

from itertools import product

import lark
import pytest
from hypothesis import assume, given, settings

from compiler.words import pushdown_automaton as pushdown_runs
from compiler.words.acceptance import accept_dfa
from compiler.words.grammar import Cfg, Rule, Srg, srg, useful_rules
from compiler.words.lr_automaton import (
    LrAutomaton,
    LrConflict,
    LrTooLarge,
    accepts,
    leftmost_derivation,
    lr_automaton,
    right_parse,
)
from compiler.words.pushdown_automaton import sra
from grammar_lang import ir
from tests.oracles.brute_force_grammar import all_words, derivations, words_of
from tests.oracles.grammars import (
    ALPHABET,
    ARM_MODULES,
    ARM_TERMINALS,
    EVERY,
    TRAPS,
    arm,
    grammar,
    random_grammars,
)
from tests.oracles.rightmost_forms import lr_actions
from tests.oracles.some_cases import examples

AB = ("a", "b")
LR1_TRAPS = {
    "left linear",
    "right linear",
    "counted",
    "branching",
    "useless",
    "empty language",
    "empty word only",
    "not LALR",
}


def of(text: str, terminals: tuple[str, ...] = ALPHABET) -> Srg:
    return srg(grammar(text, terminals), terminals, frozenset())


def automaton_of(rules: Srg) -> LrAutomaton:
    found = lr_automaton(rules.cfg)
    assert isinstance(found, LrAutomaton)
    return found


def conflict_of(rules: Srg) -> LrConflict:
    found = lr_automaton(rules.cfg)
    assert isinstance(found, LrConflict)
    return found


def table(automaton: LrAutomaton, prefix: tuple[int, ...], lookahead: int) -> set[int | str]:
    """The action after a prefix, as the oracle writes it; nothing where it is not viable."""
    state = 0
    for symbol in prefix:
        tables = automaton.actions if symbol < automaton.end else automaton.gotos
        state = tables[state].get(symbol, -1)
        if state < 0:
            return set()
    action = automaton.actions[state].get(lookahead)
    if action is None:
        return set()
    if action == automaton.accept_action:
        return {"accept"}
    return {"shift" if action >= 0 else ~action}


def reported(conflict: LrConflict) -> set[int | str]:
    """The actions of a conflict, as the oracle writes them."""
    actions: set[int | str] = {r for r in conflict.reductions if r < len(conflict.rules)}
    if len(conflict.rules) in conflict.reductions:
        actions.add("accept")
    return actions | ({"shift"} if conflict.shift else set())


# --- the tables, from the definition -----------------------------------------------------------


def check_actions(cfg: Cfg, longest: int) -> None:
    """Tables and conflicts say what the rightmost derivations say, for short prefixes."""
    found = lr_automaton(cfg)
    assert not isinstance(found, LrTooLarge)
    if isinstance(found, LrConflict):
        size = len(found.prefix)
        expected = lr_actions(cfg.terminals, found.rules, cfg.start, size)
        assert expected[found.prefix, found.lookahead] == reported(found)
        assert len(reported(found)) > 1
        assert all(len(done) == 1 for (prefix, _), done in expected.items() if len(prefix) < size)
        return
    expected = lr_actions(cfg.terminals, found.rules, cfg.start, longest)
    symbols = range(cfg.terminals + cfg.nonterminals)
    for length in range(longest + 1):
        for prefix in product(symbols, repeat=length):
            for lookahead in range(cfg.terminals + 1):
                right = expected.get((prefix, lookahead), set())
                assert table(found, prefix, lookahead) == right, (prefix, lookahead)


@settings(deadline=None, max_examples=examples(35, 100))
@given(random_grammars())
def test_actions_are_those_of_the_rightmost_derivations(g: ir.Grammar) -> None:
    check_actions(srg(g, AB, frozenset()).cfg, 3)


@pytest.mark.parametrize("name", TRAPS)
def test_actions_of_the_traps(name: str) -> None:
    rules = of(TRAPS[name])
    assert isinstance(lr_automaton(rules.cfg), LrAutomaton) == (name in LR1_TRAPS)
    check_actions(rules.cfg, 4)


@pytest.mark.parametrize(
    ("text", "terminals", "states"),
    [
        # Aho, Lam, Sethi, Ullman: figure 4.41 has I0 to I9.
        ("S -> C C\nC -> a C | b", AB, 10),
        # By hand: nothing, S, a, a S, a S b, and inside an a: a a, a a S, a a S b.
        ("S -> a S b | empty", AB, 8),
        # One chain of prefixes: N, B, N eps, and one for each of JO, L, EN.
        ("N -> B | N eps JO | N eps L | N eps EN", ARM_TERMINALS, 7),
    ],
)
def test_sizes_known_otherwise(text: str, terminals: tuple[str, ...], states: int) -> None:
    assert len(automaton_of(of(text, terminals)).actions) == states


# --- the language ------------------------------------------------------------------------------


@settings(deadline=None, max_examples=examples(15, 40))
@given(random_grammars())
def test_words_and_their_only_derivation(g: ir.Grammar) -> None:
    rules = srg(g, AB, frozenset())
    automaton = lr_automaton(rules.cfg)
    assume(isinstance(automaton, LrAutomaton))
    assert isinstance(automaton, LrAutomaton)
    labels = [rules.productions[r].label for r in useful_rules(rules.cfg)]
    pda = sra(rules, accept_dfa(EVERY, AB))
    members = words_of(g, 6)
    for word in all_words(AB, 6):
        codes = rules.encode(word)
        assert codes is not None
        assert accepts(automaton, codes) == (word in members)
        if len(word) < 5:
            assert pushdown_runs.accepts(pda, word) == (word in members)
        derivation = leftmost_derivation(automaton, codes)
        assert (derivation is None) == (word not in members)
        if derivation is not None and len(word) < 5:
            assert [tuple(labels[r] for r in derivation)] == list(derivations(g, word))


@settings(deadline=None, max_examples=examples(20, 40))
@given(random_grammars())
def test_parses_are_rightmost_derivations_in_reverse(g: ir.Grammar) -> None:
    rules = srg(g, AB, frozenset())
    automaton = lr_automaton(rules.cfg)
    assume(isinstance(automaton, LrAutomaton))
    assert isinstance(automaton, LrAutomaton)
    for word in words_of(g, 4):
        codes = rules.encode(word)
        assert codes is not None
        parse = right_parse(automaton, codes)
        assert parse is not None
        form = [rules.cfg.start]
        for r in reversed(parse):
            at = max(i for i, symbol in enumerate(form) if symbol >= automaton.end)
            assert form[at] == automaton.rules[r].left
            form[at : at + 1] = automaton.rules[r].right
        assert tuple(form) == codes


@pytest.mark.parametrize("name", sorted(LR1_TRAPS))
def test_words_of_the_traps(name: str) -> None:
    rules = of(TRAPS[name])
    automaton = automaton_of(rules)
    members = words_of(grammar(TRAPS[name], ALPHABET), 7)
    for word in all_words(ALPHABET, 7):
        assert accepts(automaton, rules.encode(word) or ()) == (word in members)


def test_numbers_that_are_no_terminals_are_refused() -> None:
    automaton = automaton_of(of("S -> S a | empty"))
    assert accepts(automaton, (0, 0))
    for wrong in (-1, 1, automaton.end, automaton.end + 1):
        for word in ((wrong,), (0, wrong), (wrong, 0), (0, wrong, 0)):
            assert not accepts(automaton, word)


def test_the_running_example() -> None:
    rules = srg(arm(), ARM_TERMINALS, ARM_MODULES)
    automaton = automaton_of(rules)
    word = rules.encode(("B", "eps", "JO", "eps", "EN"))
    assert word is not None
    assert right_parse(automaton, word) == (0, 1, 3)
    assert leftmost_derivation(automaton, word) == (3, 1, 0)


# --- against lark's LALR(1) --------------------------------------------------------------------


def lark_accepts(parser: lark.Lark, word: tuple[str, ...]) -> bool:
    try:
        parser.parse("".join(word))
    except lark.exceptions.UnexpectedInput:
        return False
    return True


@pytest.mark.parametrize(
    ("ours", "theirs"),
    [
        (TRAPS["not LALR"], 's: "a" x "a" | "b" x "b" | "a" y "b" | "b" y "a"\nx: "c"\ny: "c"'),
        (
            "S -> A a | b A c | B c | b B a\nA -> c\nB -> c",
            's: x "a" | "b" x "c" | y "c" | "b" y "a"\nx: "c"\ny: "c"',
        ),
    ],
)
def test_lr1_but_not_lalr(ours: str, theirs: str) -> None:
    with pytest.raises(lark.exceptions.GrammarError, match="Reduce/Reduce"):
        lark.Lark(theirs, start="s", parser="lalr")
    automaton = automaton_of(of(ours))
    earley = lark.Lark(theirs, start="s", parser="earley", lexer="dynamic")
    taken = [w for w in all_words(ALPHABET, 5) if accepts(automaton, of(ours).encode(w) or ())]
    assert taken == [w for w in all_words(ALPHABET, 5) if lark_accepts(earley, w)]
    assert len(taken) == 4


def test_conflicts_are_not_resolved() -> None:
    # Shifting where a reduction fits as well refuses the word aaa, which is in the language.
    text = TRAPS["odd palindromes"]
    resolved = lark.Lark('s: "a" s "a" | "a"', start="s", parser="lalr")
    assert ("a",) * 3 in words_of(grammar(text, ALPHABET), 3)
    assert not lark_accepts(resolved, ("a",) * 3)
    conflict = conflict_of(of(text))
    assert conflict.prefix == (0, 0)
    assert (conflict.lookahead, conflict.shift, conflict.reductions) == (0, True, (1,))
    # S -> a . S a, S -> a . before an a, and what S begins with.
    assert {(i.rule, i.dot) for i in conflict.items} == {(0, 1), (1, 1), (0, 0), (1, 0)}
    assert {i.lookahead for i in conflict.items} == {(0,)}


# --- conflicts ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "S -> S | a",
        "S -> T | a\nT -> S",
        "S -> E S | a\nE -> empty",
        "S -> a | a",
        "S -> a T\nT -> S | b | S",
        "S -> T T | a\nT -> empty | S",
    ],
)
def test_cycles_and_repeated_rules_are_conflicts(text: str) -> None:
    conflict = conflict_of(of(text))
    assert len(conflict.reductions) + conflict.shift > 1
    check_actions(of(text).cfg, 3)


def test_accepting_can_be_one_side_of_a_conflict() -> None:
    conflict = conflict_of(of("S -> S | a"))
    assert conflict.prefix == (3,)
    assert conflict.reductions == (0, len(conflict.rules))


def test_useless_symbols_cause_no_conflict() -> None:
    rules = of("S -> a | U\nU -> U | a U\nR -> R R | a | a")
    assert len(automaton_of(rules).rules) == 1


def test_the_empty_language() -> None:
    automaton = automaton_of(of("S -> a S"))
    assert not any(accepts(automaton, word) for word in ((), (0,), (0, 0)))


# --- size --------------------------------------------------------------------------------------


def chain(size: int) -> Srg:
    terminals = tuple(f"t{i}" for i in range(size))
    lines = [f"N{i} -> t{i} N{i} | N{i + 1}" for i in range(size)]
    return of("\n".join([*lines, f"N{size} -> empty"]), terminals)


def test_a_chain_of_sixty_nonterminals_takes_few_steps() -> None:
    # In order, each symbol any number of times: t0* t1* ... t59*.
    rules = chain(60)
    automaton = lr_automaton(rules.cfg, step_limit=40_000)
    assert isinstance(automaton, LrAutomaton)
    assert accepts(automaton, ())
    assert accepts(automaton, (0, 0, 3, 17, 17, 59))
    assert not accepts(automaton, (0, 17, 3))


def test_the_step_limit() -> None:
    assert lr_automaton(chain(60).cfg, step_limit=500) == LrTooLarge(500)
    # Each pair of terminals around a level is one more context for all levels within.
    size = 200
    rules = [Rule(size + i, (i, size + i + 1, i)) for i in range(size - 1)]
    rules += [Rule(size + i, (size + i + 1,)) for i in range(size - 1)]
    rules.append(Rule(2 * size - 1, (size - 1,)))
    found = lr_automaton(Cfg(size, size, tuple(rules), size), step_limit=100_000)
    assert found == LrTooLarge(100_000)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("S -> a S b | empty", (0,) * 50_000 + (1,) * 50_000),
        ("S -> a S b S | c", (0,) * 33_333 + (2,) + (1, 2) * 33_333),
        ("N -> a | N b", (0, *(1,) * 99_999)),
        ("N -> b N | a", (*(1,) * 99_999, 0)),
        ("T -> a | a b T c T c", (0, 1) * 25_000 + (0,) + (2, 0, 2) * 25_000),
    ],
)
def test_long_words(text: str, word: tuple[int, ...]) -> None:
    automaton = automaton_of(of(text))
    assert accepts(automaton, word)
    assert not accepts(automaton, (*word, 2))
    assert not accepts(automaton, (2, *word))
    derivation = leftmost_derivation(automaton, word)
    assert derivation is not None
    done = 0
    form = [3]
    for r in derivation:
        while form[-1] < 3:
            assert form.pop() == word[done]
            done += 1
        rule = automaton.rules[r]
        assert form.pop() == rule.left
        form += reversed(rule.right)
    assert tuple(reversed(form)) == word[done:]
