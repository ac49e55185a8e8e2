"""Ambiguous words: words of a robot family that have several derivations.

Ambiguity of a context-free grammar is undecidable (Cantor 1962; Floyd 1962).  For a grammar
without self-embedding it is decided exactly, and one that is LR(1) is unambiguous (Knuth 1965).
For any other, all words up to a length are looked at: the largest for which the words of all
nonterminals can be put together in ``STEP_LIMIT`` steps, but ``LENGTH_LIMIT`` at most.  If nothing
is found there, the first ``FIRST_DERIVATIONS`` derivations of accepted words with at most
``FIRST_MODULES`` modules are looked at too.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice, pairwise

from compiler.grammars.grammar import Cfg, trimmed
from compiler.grammars.short_words import short_words
from compiler.grammars.transition_network import transition_network
from compiler.languages.language import Language
from compiler.languages.regular_ambiguity import Decision, decide_ambiguity
from compiler.languages.structures import structures

STEP_LIMIT = 6_000
LENGTH_LIMIT = 40
FIRST_DERIVATIONS = 64
FIRST_MODULES = 6


@dataclass(frozen=True, slots=True)
class Ambiguity:
    """Ambiguous words, the first of them first: by length, then by the order of the symbols.

    ``decided``: there is an ambiguous word only if one is listed.
    """

    words: tuple[tuple[str, ...], ...]
    decided: bool


def ambiguity(language: Language, longest: int | None) -> Ambiguity:
    """The ambiguous words found within the bounds above.

    The empty word is no robot and is left aside.

    Args:
        language: the language of a grammar that is not cyclic.
        longest: the length of its longest word, None where it is infinite.
    """
    cfg = trimmed(language.srg.cfg)
    network = transition_network(cfg)
    decision = None if network is None else decide_ambiguity(network, language.accept)
    if decision == Decision(None) or (decision is None and language.is_lr):
        return Ambiguity((), decided=True)
    found, complete = _short(language, cfg, longest)
    if decision is not None and decision.word is not None and decision.word not in found:
        found.insert(0, decision.word)
    words = tuple(map(language.srg.decode, found))
    return Ambiguity(words, decided=complete or decision is not None)


def _short(language: Language, cfg: Cfg, longest: int | None) -> tuple[list[tuple[int, ...]], bool]:
    """The ambiguous words that are short, and whether all words are."""
    most = LENGTH_LIMIT if longest is None else min(longest, LENGTH_LIMIT)
    listed = short_words(cfg, STEP_LIMIT, most)
    complete = listed.length == longest
    accepted = [word for word in listed.derivations if word and _accepts(language, word)]
    found = [word for word in accepted if listed.derivations[word] > 1]
    if not found and not complete and len(accepted) < FIRST_DERIVATIONS:
        found = _first(language)
    return found, complete


def _accepts(language: Language, word: tuple[int, ...]) -> bool:
    state = 0
    for symbol in word:
        state = language.accept.step(state, symbol)
    return language.accept.accepting[state]


def _first(language: Language) -> list[tuple[int, ...]]:
    """The ambiguous words among the first derivations, which come sorted by word."""
    first = islice(structures(language, FIRST_MODULES), FIRST_DERIVATIONS)
    twice = dict.fromkeys(b.word for a, b in pairwise(first) if a.word == b.word)
    return [codes for word in twice if (codes := language.srg.encode(word)) is not None]
