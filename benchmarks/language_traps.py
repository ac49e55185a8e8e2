"""Wrong answers, reproduced: small grammars on which a library contradicts brute force."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from language_cells import TimeUp, fresh, time_limit
from language_grammars import Subject, Word, grammar, subjects
from language_peer import NotApplicableError, Peer
from language_peers import PEERS, Pyformlang, import_libraries

ALPHABET = ("a", "b", "c")
LENGTH = 5
TRAPS = {
    "odd palindromes": "S -> a S a | a",
    "even palindromes": "S -> a S a | b S b | empty",
    "hidden left recursion": "S -> E S a | b\nE -> empty | c",
    "unit cycle": "A -> A | B | a\nB -> A | b",
    "empty cycle": "A -> A A | empty | a",
    "unproductive symbols": "S -> a | U b | S b\nU -> U a",
    "empty language": "S -> a S",
    "not LALR": "S -> a A a | b A b | a B b | b B a\nA -> c\nB -> c",
}


def trap_subjects() -> Iterator[Subject]:
    """The trap grammars; they have no words of given lengths, only all the short ones."""
    from tests.oracles.brute_force_grammar import words_of

    for name, rules in TRAPS.items():
        read = grammar(name, " ".join(ALPHABET), rules)
        inside = frozenset(words_of(read, LENGTH))
        what = rules.replace("\n", ", ")
        yield Subject(name, what, read, ALPHABET, inside.__contains__, lambda _rng, _length: None)


def membership_traps(peers: Sequence[type[Peer]], seconds: float) -> Iterator[str]:
    """Per library and trap the first word that it gets wrong; then what stops it, and where."""
    from tests.oracles.brute_force_grammar import all_words

    words = [*all_words(ALPHABET, LENGTH), ("unknown",)]
    stops: dict[tuple[str, str], list[str]] = {}
    import_libraries(peers)
    for subject in trap_subjects():
        _check_ours(subject, words)
        for kind in peers:
            verdicts = list(_verdicts(kind, subject, words, seconds))
            wrong = [word for word, verdict in verdicts if not verdict]
            if wrong:
                said = "refuses" if subject.oracle(wrong[0]) else "accepts"
                number = f"{len(wrong)} of {len(words)} words are wrong"
                yield f"{kind.name:<20}{subject.what:<50}{said} {quoted(wrong[0])}; {number}"
            for word, verdict in verdicts:
                if verdict:
                    places = stops.setdefault((kind.name, verdict), [])
                    places.append(f"{quoted(word)} with {subject.what}")
    for (name, what), places in stops.items():
        more = f", and {len(places) - 1} more" if len(places) > 1 else ""
        yield f"{name:<20}{what} on {places[0]}{more}"
    number = len(words) * len(TRAPS)
    yield f"{'srgc':<20}right on all {number:,} words of these {len(TRAPS)} grammars"


def _check_ours(subject: Subject, words: Sequence[Word]) -> None:
    ours = fresh(subject)
    for word in words:
        if ours.accepts(word) is not subject.oracle(word):
            raise SystemExit(f"srgc is wrong on {subject.what}: {' '.join(word)}")


def _verdicts(
    kind: type[Peer], subject: Subject, words: Sequence[Word], seconds: float
) -> Iterator[tuple[Word, str]]:
    """The words with a wrong answer, verdict empty, or with none, and why; one time-out ends it."""
    try:
        with time_limit(20 * seconds):
            peer = kind(subject.grammar)
    except (NotApplicableError, TimeUp):
        return
    for word in words:
        try:
            with time_limit(seconds):
                if peer.accepts(peer.encode(word)) is not subject.oracle(word):
                    yield word, ""
        except TimeUp:
            yield word, f"no answer in {seconds:g} s"
            return
        except Exception as error:
            yield word, type(error).__name__


def quoted(word: Word) -> str:
    """The word for a reader; a long one by its ends."""
    if len(word) > 24:
        return f"'{' '.join(word[:8])} ... {' '.join(word[-8:])}' ({len(word)} symbols)"
    return f"'{' '.join(word)}'" if word else "the empty word"


# --- other operations -----------------------------------------------------------------------------


def operation_traps(seconds: float) -> Iterator[str]:
    """Compositions and spellings with a result that is not what they say."""
    import_libraries(PEERS)
    traps: tuple[Callable[[], str], ...] = (
        _pushdown_intersection,
        _upper_case_terminals,
        _repeated_words,
        _long_word_recursion,
    )
    for trap in traps:
        try:
            with time_limit(10 * seconds):
                found = trap()
        except TimeUp:
            found = f"{trap.__name__.strip('_')}: no answer in {10 * seconds:g} s"
        if found:
            yield found


def _pushdown_intersection() -> str:
    """``to_pda`` accepts by empty stack, the intersection of PDAs is made for final states."""
    from pyformlang.finite_automaton import DeterministicFiniteAutomaton as Dfa

    from tests.oracles.brute_force_grammar import words_of

    paper = next(subjects())
    peer = Pyformlang(paper.grammar)
    letters = {token: peer.encode((token,))[0].value for token in paper.terminals}
    ends = Dfa()
    ends.add_start_state(0)
    ends.add_final_state(1)
    ends.add_transitions(
        (state, letter, int(token == "EN")) for token, letter in letters.items() for state in (0, 1)
    )
    both: Any = (peer.cfg.to_pda() & ends).to_cfg()
    for word in sorted(words_of(paper.grammar, LENGTH), key=lambda w: (len(w), w)):
        answer = both.contains(peer.encode(word))
        if answer is not (word[-1] == "EN"):
            return (
                "pyformlang          (cfg.to_pda() & dfa).to_cfg() on the paper's grammar and "
                f"'ends with EN': {'accepts' if answer else 'refuses'} {quoted(word)}"
            )
    return ""


def _upper_case_terminals() -> str:
    from pyformlang.cfg import CFG

    read = CFG.from_text("N -> B | N eps JO", start_symbol="N")
    if read.contains(["B"]):
        return ""
    return (
        "pyformlang          CFG.from_text('N -> B | N eps JO') reads B and JO as variables "
        "without a production: refuses 'B'"
    )


def _repeated_words() -> str:
    from automata.fa.dfa import DFA

    dfa = DFA(
        states={0, 1, 2},
        input_symbols={"J", "O", "JO"},
        transitions={0: {"J": 1, "JO": 2}, 1: {"O": 2}, 2: {}},
        initial_state=0,
        final_states={2},
        allow_partial=True,
    )
    words = list(dfa)
    if len(set(words)) == len(words):
        return ""
    return f"automata-lib DFA    words over J, O, JO run together: the iteration gives {words}"


def _long_word_recursion() -> str:
    """genlm's own call, of which the adapter avoids the recursion."""
    from genlm.grammar.cfg import CFG
    from genlm.grammar.parse.earley import Earley
    from genlm.grammar.semiring import Boolean

    cfg = CFG(R=Boolean, S="S", V={"a"})
    cfg.add(Boolean.one, "S", "a", "S")
    cfg.add(Boolean.one, "S", "a")
    try:
        Earley(cfg)(("a",) * 1000)
    except RecursionError:
        return (
            "genlm Earley        S -> a S | a: called with a word of 1000 symbols, RecursionError"
        )
    return ""
