"""The reports about words: the language of a robot family, its automata, membership, lists."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from itertools import islice
from random import Random

from compiler.words.ambiguity import ambiguity
from compiler.words.derivation import Derivation, replay
from compiler.words.deterministic_pushdown import deterministic_pushdown
from compiler.words.equivalence import compare
from compiler.words.grammar import cyclic, linearity, trimmed, useful_rules
from compiler.words.language import Language, language
from compiler.words.lr_automaton import LrAutomaton, LrConflict, LrTooLarge
from compiler.words.pushdown_automaton import Pda, Transition, accepting_run, run_along, sra
from compiler.words.recogniser import PushdownMembership, viable_prefix
from compiler.words.regular_automaton import transition_network
from compiler.words.sampling import WordSampler
from compiler.words.structures import derivations_of
from grammar_lang import ir
from srgc.session import UsageFault

MOST_TRANSITIONS = 20_000

EMPTY_WORD = "(empty word)"
"""The text for the word without symbols; no symbol has this name."""

READERS = {
    "finite automaton": "a finite automaton",
    "pushdown automaton": "a pushdown automaton whose states are sets of what may follow",
}


def language_text(program: ir.Program, grammar: ir.Grammar) -> str:
    """The text of ``srgc language``."""
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
        ("read by", READERS[family.membership.kind]),
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
    return f"{live} states, minimal" + ("" if live == dfa.size else ", and a dead one")


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
    """The prefix and the lookahead at which an LR(1) conflict leaves the next step open."""
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
    yield "ambiguous", f"yes: {' '.join(found.words[0]) or EMPTY_WORD}"
    for derivation in islice(derivations_of(family, found.words[0]), 2):
        yield "  derived by", " ".join(derivation.labels)


# --------------------------------------------------------------------------------------------------
# ``srgc accepts``: membership, and on request the run of the automaton and a derivation.


SHOWN_STACK = 8
"""The number of symbols to show from the top of the stack."""
SHOWN_WORD = 12
"""The number of symbols to show of a prefix that no word continues."""


def acceptance_text(
    program: ir.Program, grammar: ir.Grammar, word: tuple[str, ...], *, trace: bool
) -> tuple[bool, str]:
    """Whether the word is accepted, and the text to print."""
    family = language(grammar, program.terminals, program.modules)
    if not family.accepts(word):
        return False, f"not accepted: {_reason(family, word)}"
    if not trace:
        return True, "accepted"
    pda = sra(family.srg, family.accept)
    derivation = _first_derivation(family, grammar, pda, word)
    run = run_along(pda, derivation.labels)
    lines = ["accepted", *_run(pda, run), *_derivation(derivation)]
    return True, "\n".join(lines)


def _first_derivation(
    family: Language, grammar: ir.Grammar, pda: Pda, word: tuple[str, ...]
) -> Derivation:
    """The first derivation of a word; an arbitrary one if there may be infinitely many."""
    if not cyclic(trimmed(family.srg.cfg)):
        return next(derivations_of(family, word))
    run = accepting_run(pda, word) or ()
    return replay(grammar, tuple(step.label for step in run if step.label is not None))


def _reason(family: Language, word: tuple[str, ...]) -> str:
    names = family.srg.terminals
    unknown = next((symbol for symbol in word if symbol not in names), None)
    if unknown is not None:
        return f"`{unknown}` is not a symbol of the file"
    length = viable_prefix(family.binary, names, word)
    if length < len(word):
        shown = " ".join(word[max(0, length + 1 - SHOWN_WORD) : length + 1])
        cut = "… " if length >= SHOWN_WORD else ""
        return f"no word of the grammar begins with `{cut}{shown}` ({length + 1} symbols)"
    if PushdownMembership(family.binary, names).accepts(word):
        return "the grammar derives it, but the accept condition does not hold"
    return "it is only the beginning of a word" if word else "the grammar does not derive it"


def _run(pda: Pda, run: Sequence[Transition]) -> Iterator[str]:
    """The configurations (symbols read, state, stack), each with the step to the next one."""
    yield ""
    yield "run of the pushdown automaton (symbols read, state, stack from its top; step):"
    stack = list(reversed(pda.initial_stack))
    rows: list[tuple[str, str, str, str]] = []
    position, state = 0, pda.initial
    for step in run:
        rows.append((str(position), pda.states[state], _stack(pda, stack), _step(pda, step)))
        stack.pop()
        stack += reversed(step.push)
        position += step.read is not None
        state = step.target
    rows.append((str(position), pda.states[state], _stack(pda, stack), "accepted"))
    widths = [max(len(row[i]) for row in rows) for i in range(3)]
    for row in rows:
        cells = [row[0].rjust(widths[0]), row[1].ljust(widths[1]), row[2].ljust(widths[2])]
        yield f"  {'  '.join(cells)}  {row[3]}"


def _stack(pda: Pda, stack: Sequence[int]) -> str:
    shown = [pda.stack_alphabet[symbol] for symbol in stack[: -SHOWN_STACK - 1 : -1]]
    rest = len(stack) - len(shown)
    return " ".join([*shown, *([f"… {rest} more"] if rest else [])]) or "empty"


def _step(pda: Pda, step: Transition) -> str:
    if step.read is not None:
        return f"read {pda.alphabet[step.read]}"
    if step.label is None:
        return "end"
    left = pda.stack_alphabet[step.pop]
    right = " ".join(pda.stack_alphabet[symbol] for symbol in step.push) or "empty"
    return f"{step.label}: {left} -> {right}"


def _derivation(derivation: Derivation) -> Iterator[str]:
    """The productions of the leftmost derivation, each with the part of the word it derives."""
    yield ""
    yield "leftmost derivation (production, which symbols it derives):"
    label = max(len(node.production.label) for node in derivation.nodes)
    width = 2 * len(str(len(derivation.word))) + 2
    for node, (begin, end) in zip(derivation.nodes, derivation.spans(), strict=True):
        production = node.production
        right = " ".join(symbol.name for symbol in production.right) or "empty"
        part = f"{begin + 1}..{end}" if begin < end else "none"
        yield f"  {production.label:<{label}}  {part:<{width}}  {production.left} -> {right}"


# --- ``srgc compare``: whether two grammars have the same words -----------------------------------


def comparison_text(
    program: ir.Program, first: ir.Grammar, second: ir.Grammar, max_length: int
) -> tuple[bool, str]:
    """Whether no difference is found, and the text to print.

    Raises:
        BudgetExceededError: the comparison would take too long.
    """
    families = [language(g, program.terminals, program.modules) for g in (first, second)]
    found = compare(families[0], families[1], max_length)
    if found.word is not None:
        owner, other = (first, second) if found.in_first else (second, first)
        word = " ".join(found.word) or "the empty word"
        return False, f"different: {owner.name} has a word that {other.name} has not:\n{word}"
    if found.longest is None:
        return True, f"{first.name} and {second.name} have the same words"
    return True, (
        f"{first.name} and {second.name} have the same words of at most {found.longest} symbols; "
        "longer ones were not compared"
    )


# --- ``srgc words``: the lines of the list, of the counts, and of the sample ----------------------


def nothing_listed(family: ir.Grammar, shortest: str | None, max_length: int | None) -> str:
    """Why a list of words is empty; ``shortest`` is the shortest word of the family, if any."""
    if shortest is None:
        return f"grammar `{family.name}` has no words"
    length = len(shortest.split())
    if max_length is not None and length > max_length:
        least = f"{length} symbol{'' if length == 1 else 's'}"
        return f"the shortest word of grammar `{family.name}` has {least}: `{shortest}`"
    return "no word was asked for"


def listed(
    program: ir.Program, grammar: ir.Grammar, max_length: int | None, limit: int
) -> Iterator[str]:
    """The first ``limit`` words, one per line."""
    family = language(grammar, program.terminals, program.modules)
    return map(" ".join, islice(family.words(max_length=max_length), min(limit, sys.maxsize)))


def counted(program: ir.Program, grammar: ir.Grammar, max_length: int | None) -> Iterator[str]:
    """The number of words of each length.

    Raises:
        UsageFault: the language is infinite and no length is given.
        BudgetExceededError: counting would take too long.
    """
    family = language(grammar, program.terminals, program.modules)
    if max_length is None and not family.is_finite():
        raise UsageFault("the language is infinite: give --max-length to count it")
    counts = family.count_words(max_length)
    return (f"{length} {number}" for length, number in enumerate(counts))


def sampled(
    program: ir.Program, grammar: ir.Grammar, length: int, number: int, seed: int
) -> Iterator[str]:
    """Words of one length, drawn independently and uniformly.

    Raises:
        UsageFault: there is no word of that length.
        BudgetExceededError: drawing would take too long.
    """
    family = language(grammar, program.terminals, program.modules)
    sampler = WordSampler(family, length)
    if not sampler.number:
        raise UsageFault(f"there is no word of {length} symbols")
    random = Random(seed)  # noqa: S311  (a sample, not a secret)
    return (" ".join(sampler.draw(random)) for _ in range(number))
