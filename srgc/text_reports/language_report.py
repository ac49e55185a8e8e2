"""``srgc language``: what kind of language a robot family is, and by what automata it is read."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

from compiler.words.ambiguity import ambiguity
from compiler.words.deterministic_pushdown import deterministic_pushdown
from compiler.words.grammar import cyclic, linearity, trimmed, useful_rules
from compiler.words.language import Language, language
from compiler.words.lr_automaton import LrAutomaton, LrConflict, LrTooLarge
from compiler.words.pushdown_automaton import sra
from compiler.words.structures import derivations_of
from compiler.words.transition_network import transition_network
from grammar_lang import ir

MOST_TRANSITIONS = 20_000

READERS = {
    "finite automaton": "a finite automaton",
    "pushdown automaton": "a pushdown automaton whose states are sets of what may follow",
}


def language_text(program: ir.Program, grammar: ir.Grammar) -> str:
    """What ``srgc language`` prints."""
    family = language(grammar, program.terminals, program.modules)
    rows = [
        ("productions", str(len(grammar.productions))),
        ("nonterminals", str(len(grammar.nonterminals))),
        ("form", _form(family)),
        ("pushdown automaton", _pushdown(family)),
        ("finite automaton", _finite(family)),
        ("LR(1) automaton", _lr(family)),
        ("words", _size(family)),
        ("shortest word", _shortest(family)),
        *_ambiguity(family),
        ("read by", READERS[family.recogniser.kind]),
    ]
    return "\n".join(f"{name + ':':<20}{text}" for name, text in rows)


def _form(family: Language) -> str:
    side = linearity(trimmed(family.srg.cfg))
    return "context-free, not linear" if side is None else f"{side}-linear"


def _pushdown(family: Language) -> str:
    pda = sra(family.srg, family.accept)
    return f"{len(pda.states)} states, {len(pda.transitions)} transitions"


def _finite(family: Language) -> str:
    dfa = family.finite_automaton
    if dfa is None and _shown_regular(family):
        return "not made: its construction takes too many states"
    if dfa is None:
        return "none: the form of the grammar does not show that its language is regular"
    live = sum(dfa.live())
    return f"{live} states, minimal" + ("" if live == dfa.size else ", and one without a way out")


def _shown_regular(family: Language) -> bool:
    """Whether the form of the grammar shows that its language is regular."""
    cfg = trimmed(family.srg.cfg)
    if linearity(cfg) is not None:
        return True
    return not cyclic(cfg) and transition_network(cfg) is not None


def _lr(family: Language) -> str:
    found = family.lr_automaton
    if isinstance(found, LrAutomaton):
        pda = deterministic_pushdown(family.srg, found, family.accept, MOST_TRANSITIONS)
        size = (
            f"over {MOST_TRANSITIONS} transitions"
            if isinstance(pda, LrTooLarge)
            else f"{len(pda.states)} states, {len(pda.transitions)} transitions"
        )
        return f"{len(found.actions)} states, no conflict; as a deterministic pushdown one {size}"
    if isinstance(found, LrConflict):
        return f"none: {_conflict(family, found)}"
    return f"not looked for any more after {found.steps} steps"


def _conflict(family: Language, conflict: LrConflict) -> str:
    """After which symbols, seeing what, the next step is open."""
    names = (*family.srg.terminals, *family.srg.nonterminals)
    at_end = conflict.lookahead == family.srg.cfg.terminals
    after = " ".join(names[s] for s in conflict.prefix)
    seen = "the end" if at_end else f"`{names[conflict.lookahead]}`"
    number = useful_rules(family.srg.cfg)
    steps = ["to read on"] if conflict.shift else []
    for rule in conflict.reductions:
        end = rule == len(conflict.rules)
        label = "" if end else family.srg.productions[number[rule]].label
        steps.append("to end" if end else f"to finish `{label}`")
    place = f"after `{after}`" if after else "at the beginning"
    return f"{place}, before {seen}, it is open whether {' or '.join(steps)}"


def _size(family: Language) -> str:
    if family.is_empty():
        return "none"
    longest = family.longest()
    if longest is None:
        return "infinitely many"
    return f"finitely many, the longest of {longest} symbol{'' if longest == 1 else 's'}"


def _shortest(family: Language) -> str:
    word = family.shortest_word()
    return "none" if word is None else " ".join(word) or "the empty word"


def _ambiguity(family: Language) -> Iterator[tuple[str, str]]:
    if family.is_empty():
        yield "ambiguous", "no"
        return
    loops = family.srg.names(cyclic(trimmed(family.srg.cfg)))
    if loops:
        yield "ambiguous", f"yes, without end: {loops[0]} derives itself"
        return
    found = ambiguity(family, family.longest())
    if not found.words:
        yield "ambiguous", "no" if found.decided else "no ambiguous word was found"
        return
    yield "ambiguous", f"yes: {' '.join(found.words[0])}"
    for derivation in islice(derivations_of(family, found.words[0]), 2):
        yield "  derived by", " ".join(derivation.labels)
