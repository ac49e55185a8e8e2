"""The first words of the paper's grammar with its accept condition, and how many there are.

Each enumeration is a process of its own, so that its peak of memory is its own: this file run
with the name of a contestant prints what it measured as JSON.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import time
import tracemalloc
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import partial
from itertools import islice
from typing import Any

from language_cells import TimeUp, time_limit, timed
from language_grammars import Word, subjects
from language_peers import Pyformlang
from timing import ROOT

from compiler.words.language import Language, language
from grammar_lang import ir

WORDS = 100_000
EARLY = 10_000
LONGEST = 200
ACCEPT = ir.AllOf((ir.Contains(("EN",)), ir.StartsWith(("B", "eps", "JO"))))
LETTERS = {"B": "b", "JO": "j", "L": "l", "EN": "t", "eps": "e"}
PATTERN = "bej(e(j|l|t))*et(e(j|l|t))*"
"""The same language, one character a symbol: two of the contestants cannot compute it."""


def _ours() -> Language:
    paper = next(subjects())
    return language(replace(paper.grammar, accept=ACCEPT), paper.terminals, paper.modules)


def _srgc() -> Iterable[Word]:
    return _ours().words()


def _automata_dfa() -> Any:
    from automata.fa.dfa import DFA
    from automata.fa.nfa import NFA

    return DFA.from_nfa(NFA.from_regex(PATTERN))


def _pyformlang() -> Iterable[Word]:
    from pyformlang.regular_expression import Regex

    paper = next(subjects())
    peer = Pyformlang(paper.grammar)
    names = {LETTERS[t]: str(peer.encode((t,))[0].value) for t in paper.terminals}
    back = {names[letter]: token for token, letter in LETTERS.items()}
    condition = Regex(" ".join(names.get(character, character) for character in PATTERN))
    both = peer.cfg.intersection(condition.to_epsilon_nfa().to_deterministic().minimize())
    return (tuple(back[terminal.value] for terminal in word) for word in both.get_words())


CONTESTANTS: dict[str, Callable[[], Iterable[Any]]] = {
    "srgc": _srgc,
    "automata-lib DFA": _automata_dfa,
    "pyformlang": _pyformlang,
}


def number_of_words(length: int) -> int:
    """B eps JO, then pairs of an edge and one of three modules, at least one of them EN."""
    pairs = length // 2 - 1
    return 3**pairs - 2**pairs if length % 2 and pairs > 0 else 0


def is_right(words: list[str]) -> bool:
    """In order of length, distinct, of the language, complete for all lengths but the last."""
    counts: dict[int, int] = {}
    for word in words:
        counts[len(word)] = counts.get(len(word), 0) + 1
    lengths = list(map(len, words))
    last = lengths[-1]
    return (
        lengths == sorted(lengths)
        and len(set(words)) == len(words)
        and all(map(re.compile(PATTERN).fullmatch, words))
        and all(counts.get(n, 0) == number_of_words(n) for n in range(last))
    )


def measured(name: str, seconds: float) -> dict[str, Any]:
    """Words and seconds, then in another pass the peak of memory; the words are not kept."""
    make = CONTESTANTS[name]
    make()  # imports what it needs
    started = time.process_time()
    number, _ = _drained(make, seconds, lambda: None)
    found: dict[str, Any] = {"words": number, "seconds": time.process_time() - started}
    tracemalloc.start()
    peak = partial(_peak, tracemalloc.get_traced_memory()[0])
    _, early = _drained(make, 3 * seconds, peak)
    found |= {"early": early, "peak": peak()}
    tracemalloc.stop()
    if number == WORDS:
        words = ["".join(LETTERS.get(t, t) for t in word) for word in islice(make(), WORDS)]
        found["right"] = is_right(words)
    return found


def _drained(
    make: Callable[[], Iterable[Any]], seconds: float, probe: Callable[[], float | None]
) -> tuple[int, float | None]:
    """How many of the words came in time, and what the probe said after the first of them."""
    number, early = 0, None
    try:
        with time_limit(seconds):
            for _ in islice(make(), WORDS):
                number += 1
                if number == EARLY:
                    early = probe()
    except TimeUp:
        pass
    return number, early


def _peak(before: int) -> float:
    return (tracemalloc.get_traced_memory()[1] - before) / 2**20


def enumeration_lines(seconds: float) -> Iterator[str]:
    """The table of the enumerations, one process each, and the counts."""
    yield (f"{'the first 100,000 words':<28}{'words':>9}{'cpu s':>9}{'peak MiB':>12}   of 10,000")
    for name in CONTESTANTS:
        command = [sys.executable, __file__, name, str(seconds)]
        result = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
        if result.returncode:
            yield f"{name:<28}{result.stderr.strip().splitlines()[-1]}"
            continue
        yield _line(name, json.loads(result.stdout))
    yield from count_lines()


def _line(name: str, found: dict[str, Any]) -> str:
    if not found.get("right", True):
        raise SystemExit(f"{name} lists other words")
    early = "" if found["early"] is None else f"{found['early']:.1f}"
    stopped = "" if found["words"] == WORDS else "  stopped by the time limit"
    return (
        f"{name:<28}{found['words']:>9,}{found['seconds']:>9.2f}{found['peak']:>12.1f}{early:>12}"
        f"{stopped}"
    )


def count_lines() -> Iterator[str]:
    """How many words there are of each length up to 200, from scratch."""
    counts: dict[str, list[int]] = {}

    def ours() -> None:
        counts["srgc"] = list(_ours().count_words(LONGEST))

    def theirs() -> None:
        dfa = _automata_dfa()
        counts["automata-lib DFA"] = [dfa.count_words_of_length(n) for n in range(LONGEST + 1)]

    yield f"{f'words per length to {LONGEST}':<37}{'cpu s':>9}"
    for name, action in (("srgc", ours), ("automata-lib DFA", theirs)):
        action()
        best = min(timed(action) for _ in range(3))
        if counts[name] != [number_of_words(n) for n in range(LONGEST + 1)]:
            raise SystemExit(f"{name} counts wrongly")
        yield f"{name:<37}{best:>9.4f}"


if __name__ == "__main__":
    print(json.dumps(measured(sys.argv[1], float(sys.argv[2]))))
