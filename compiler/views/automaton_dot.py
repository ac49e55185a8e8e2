"""DOT texts of the objects: the SRA, finite automata, the words-as-states view, the grammar.

The texts are deterministic: nodes and edges come in the order of the objects they show.  The empty
word is written with the Greek letter, because ``eps`` is an ordinary edge symbol (Gamma).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from compiler.automata.acceptance import accept_dfa
from compiler.automata.finite_automaton import Dfa
from compiler.automata.pushdown_automaton import Pda, Transition
from compiler.grammars.grammar import Srg
from compiler.languages.language import Language, restrict
from grammar_lang import ir

EMPTY = "ε"
ARROW = "→"


def sra_dot(pda: Pda) -> str:
    """The pushdown automaton; an edge says ``read, top of stack -> what replaces it``."""
    lines = _opening("sra", "circle")
    lines.append(f"  init -> s{pda.initial} [label={_quoted(_stack(pda, pda.initial_stack))}];")
    for state, name in enumerate(pda.states):
        lines.append(_node(f"s{state}", name, double=state == pda.final))
    labels: dict[tuple[int, int], list[str]] = {}
    for transition in pda.transitions:
        ends = (transition.state, transition.target)
        labels.setdefault(ends, []).append(_move(pda, transition))
    lines += _edges((f"s{p}", f"s{q}", "\n".join(texts)) for (p, q), texts in labels.items())
    return _closing(lines)


def dfa_dot(dfa: Dfa) -> str:
    """A finite automaton; states from which no word is accepted are left out."""
    lines = _opening("dfa", "circle")
    lines.append("  init -> s0;")
    live = dfa.live()
    shown = [state for state in range(dfa.size) if live[state] or state == 0]
    lines += [_node(f"s{s}", f"q{s}", double=dfa.accepting[s]) for s in shown]
    labels: dict[tuple[int, int], list[str]] = {}
    for state in shown:
        for symbol, name in enumerate(dfa.alphabet):
            target = dfa.step(state, symbol)
            if live[target]:
                labels.setdefault((state, target), []).append(name)
    lines += _edges((f"s{p}", f"s{q}", "\n".join(texts)) for (p, q), texts in labels.items())
    return _closing(lines)


def words_dot(language: Language, depth: int) -> str:
    """The paper's Figure 2: words as states, unfolded to robots of ``depth`` modules.

    States are the non-empty words of L(SRG) with at most ``depth`` modules; double circles are
    those that the accept condition accepts too.  A transition adds modules (backwards, removes
    them).  It leads to a word from its longest proper prefix among the states; where none of them
    is a prefix, from every state that is a maximal proper subsequence of it, so that right-linear,
    nested and branching grammars grow in the right places as well.  States without such a
    predecessor are initial.  Edges are labelled with the symbols added.  Where edges alone can
    repeat without bound, words of more than ``2 * depth + 1`` symbols are left out.
    """
    everything = restrict(language.srg, accept_dfa(ir.AllOf(()), language.srg.terminals))
    finite = everything.is_finite(max_modules=depth)
    found = everything.words(max_modules=depth, max_length=None if finite else 2 * depth + 1)
    words = [word for word in found if word]
    number = {word: i for i, word in enumerate(words)}
    lines = _opening("words", "ellipse")
    edges: list[tuple[str, str, str]] = []
    for i, word in enumerate(words):
        lines.append(_node(f"w{i}", " ".join(word), double=language.accept.accepts(word)))
        before = _predecessors(word, number)
        if not before:
            edges.append(("init", f"w{i}", ""))
        edges += [(f"w{number[w]}", f"w{i}", " ".join(_added(w, word) or ())) for w in before]
    return _closing(lines + _edges(edges))


def grammar_dot(srg: Srg) -> str:
    """Nonterminals (ellipses) with their productions (boxes); edges number the right side."""
    lines = _opening("grammar", "ellipse")
    nonterminal = {name: f"n{k}" for k, name in enumerate(srg.nonterminals)}
    terminal = {name: f"t{k}" for k, name in enumerate(srg.terminals)}
    lines.append(f"  init -> {nonterminal[srg.start]};")
    lines += [_node(key, name) for name, key in nonterminal.items()]
    used = {s.name for p in srg.productions for s in p.right if s.kind != "nonterminal"}
    lines += [
        f"  {key} [label={_quoted(name)}, shape=plaintext];"
        for name, key in terminal.items()
        if name in used
    ]
    edges: list[tuple[str, str, str]] = []
    for r, production in enumerate(srg.productions):
        lines.append(f"  p{r} [label={_quoted(production.label)}, shape=box];")
        edges.append((nonterminal[production.left], f"p{r}", ""))
        for i, symbol in enumerate(production.right, start=1):
            table = nonterminal if symbol.kind == "nonterminal" else terminal
            edges.append((f"p{r}", table[symbol.name], str(i)))
    return _closing(lines + _edges(edges))


# --- words -------------------------------------------------------------------------------------


def _predecessors(
    word: tuple[str, ...], states: dict[tuple[str, ...], int]
) -> list[tuple[str, ...]]:
    """The states that a word is reached from; ``states`` are in order of length."""
    for size in range(len(word) - 1, 0, -1):
        if word[:size] in states:
            return [word[:size]]
    maximal: list[tuple[str, ...]] = []
    inside = [w for w in states if len(w) < len(word) and _added(w, word) is not None]
    for candidate in reversed(inside):
        if all(_added(candidate, known) is None for known in maximal):
            maximal.append(candidate)
    return maximal[::-1]


def _added(part: tuple[str, ...], word: tuple[str, ...]) -> tuple[str, ...] | None:
    """What is added to ``part`` to get ``word``; None where it is no subsequence."""
    matched = 0
    rest: list[str] = []
    for symbol in word:
        if matched < len(part) and part[matched] == symbol:
            matched += 1
        else:
            rest.append(symbol)
    return tuple(rest) if matched == len(part) else None


# --- DOT ---------------------------------------------------------------------------------------


def _opening(name: str, shape: str) -> list[str]:
    return [
        f"digraph {name} {{",
        "  rankdir=LR;",
        f"  node [shape={shape}];",
        '  init [label="", shape=none, width=0, height=0];',
    ]


def _closing(lines: Sequence[str]) -> str:
    return "\n".join((*lines, "}")) + "\n"


def _node(key: str, label: str, *, double: bool = False) -> str:
    return f"  {key} [label={_quoted(label)}{', peripheries=2' if double else ''}];"


def _edges(edges: Iterable[tuple[str, str, str]]) -> list[str]:
    return [
        f"  {tail} -> {head}{f' [label={_quoted(label)}]' if label else ''};"
        for tail, head, label in edges
    ]


def _quoted(text: str) -> str:
    """A DOT string; backslashes would otherwise be read as escapes of labels."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


def _stack(pda: Pda, symbols: Iterable[int]) -> str:
    return " ".join(pda.stack_alphabet[s] for s in symbols) or EMPTY


def _move(pda: Pda, transition: Transition) -> str:
    read = EMPTY if transition.read is None else pda.alphabet[transition.read]
    top = pda.stack_alphabet[transition.pop]
    return f"{read}, {top} {ARROW} {_stack(pda, transition.push)}"
