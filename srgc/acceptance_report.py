"""``srgc accepts``: membership, with the run of the automaton and a derivation where asked for."""

from __future__ import annotations

from compiler.automata.pushdown_automaton import (
    Configuration,
    accepting_run,
    accepts,
    configurations,
    sra,
)
from compiler.languages.derivation import Derivation, replay
from compiler.languages.language import language
from grammar_lang import ir


def acceptance_text(
    program: ir.Program, grammar: ir.Grammar, word: tuple[str, ...], *, trace: bool
) -> tuple[bool, str]:
    """Whether the word is accepted, and what to print."""
    family = language(grammar, program.terminals, program.modules)
    pda = sra(family.srg, family.accept)
    unknown = [symbol for symbol in word if symbol not in program.terminals]
    if not trace:
        accepted = accepts(pda, word)
        reason = f": `{unknown[0]}` is no symbol of the file" if unknown else ""
        return accepted, "accepted" if accepted else f"not accepted{reason}"
    run = accepting_run(pda, word)
    if run is None:
        return False, f"not accepted{f': `{unknown[0]}` is no symbol' if unknown else ''}"
    lines = ["accepted", "", "run of the pushdown automaton (state, remaining word, stack):"]
    lines += [f"  {_configuration(c)}" for c in configurations(pda, word, run)]
    derivation = replay(grammar, tuple(step.label for step in run if step.label is not None))
    lines += ["", "leftmost derivation:", *_sentential_forms(derivation)]
    return True, "\n".join(lines)


def _configuration(at: Configuration) -> str:
    return f"({at.state}, {' '.join(at.remaining) or 'empty'}, {' '.join(at.stack) or 'empty'})"


def _sentential_forms(derivation: Derivation) -> list[str]:
    """The sentential forms of the derivation that the run follows, with the production applied."""
    done: list[str] = []
    pending = [derivation.nodes[0].production.left]
    lines = [f"  {pending[0]}"]
    nonterminals = {node.production.left for node in derivation.nodes}
    for node in derivation.nodes:
        while pending and pending[0] not in nonterminals:
            done.append(pending.pop(0))
        pending[:1] = [symbol.name for symbol in node.production.right]
        form = " ".join([*done, *pending]) or "empty"
        lines.append(f"  => {form}    [{node.production.label}]")
    return lines
