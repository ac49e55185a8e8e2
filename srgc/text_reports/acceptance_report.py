"""``srgc accepts``: membership, with the run of the automaton and a derivation where asked for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.words.derivation import Derivation, replay
from compiler.words.grammar import cyclic, trimmed
from compiler.words.language import Language, language
from compiler.words.pushdown_automaton import Pda, Transition, run_along, sra
from compiler.words.pushdown_runs import accepting_run
from compiler.words.recogniser import PushdownReader
from compiler.words.structures import derivations_of
from compiler.words.word_reader import viable_prefix
from grammar_lang import ir

SHOWN_STACK = 8
"""So many symbols are shown from the top of the stack."""
SHOWN_WORD = 12
"""So many symbols are shown of the word that cannot go on."""


def acceptance_text(
    program: ir.Program, grammar: ir.Grammar, word: tuple[str, ...], *, trace: bool
) -> tuple[bool, str]:
    """Whether the word is accepted, and what to print."""
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
    """The first one; any one where there may be infinitely many."""
    if not cyclic(trimmed(family.srg.cfg)):
        return next(derivations_of(family, word))
    run = accepting_run(pda, word) or ()
    return replay(grammar, tuple(step.label for step in run if step.label is not None))


def _reason(family: Language, word: tuple[str, ...]) -> str:
    names = family.srg.terminals
    unknown = next((symbol for symbol in word if symbol not in names), None)
    if unknown is not None:
        return f"`{unknown}` is no symbol of the file"
    length = viable_prefix(family.binary, names, word)
    if length < len(word):
        shown = " ".join(word[max(0, length + 1 - SHOWN_WORD) : length + 1])
        cut = "… " if length >= SHOWN_WORD else ""
        return f"no word of the grammar begins with `{cut}{shown}` ({length + 1} symbols)"
    if PushdownReader(family.binary, names).accepts(word):
        return "the grammar derives it, but the accept condition does not hold"
    return "it is only the beginning of a word" if word else "the grammar does not derive it"


def _run(pda: Pda, run: Sequence[Transition]) -> Iterator[str]:
    """The configurations: symbols read so far, state, stack; and what leads to the next one."""
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
