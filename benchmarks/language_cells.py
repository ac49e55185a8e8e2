"""One cell of the tables: a library and ours read the same words, in turn, within a time limit.

Times are of the processor, medians over rounds; ratios are medians of the ratios of the rounds.
Each round builds our recogniser anew, so that it has not seen the words; that is not timed here.
It makes the states of its automaton while it reads: ``ratio`` is of one that has read other words
of the length before, ``new_ratio`` of one that has read nothing.
"""

from __future__ import annotations

import gc
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from statistics import median
from typing import Any

from language_grammars import Subject, Word
from language_peer import Peer

from compiler.words.language import Language, language

SHARE = 4
"""Rounds may take the time limit divided by this; the limit itself is for a single word."""


class TimeUp(BaseException):
    """The time limit; no library that catches every Exception can swallow it."""


@dataclass(frozen=True)
class Cell:
    """Seconds per word, and how many times ours; or why there is none."""

    seconds: float | None = None
    ratio: float | None = None
    new_ratio: float | None = None
    warm: float | None = None
    again: float | None = None
    failure: str = ""
    wrong: tuple[Word, ...] = ()


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Raise ``TimeUp`` in the block after so many seconds of wall time.

    A timer of processor time would make Linux round that clock to its ticks.
    """

    def up(_number: int, _frame: Any) -> None:
        raise TimeUp

    before = signal.signal(signal.SIGALRM, up)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def fresh(subject: Subject) -> Language:
    """Our language, compiled as far as it can be before it reads a word."""
    found = language(subject.grammar, subject.terminals, subject.modules)
    kind_of(found)
    return found


def kind_of(found: Language) -> str:
    """Which engine reads the words."""
    return str(getattr(getattr(found, "membership", None), "kind", "unknown"))


def timed(action: Callable[[], object]) -> float:
    """The processor time of a call that does not pay for the rubbish of the one before."""
    gc.collect()
    started = time.process_time()
    action()
    return time.process_time() - started


def _pass(accepts: Callable[[Any], bool], words: Sequence[Any]) -> tuple[float, list[bool]]:
    gc.collect()
    started = time.process_time()
    answers = [accepts(word) for word in words]
    return time.process_time() - started, answers


def measure_ours(
    subject: Subject, words: Sequence[Word], rounds: int, seconds: float, *, truth: bool
) -> Cell:
    """The first half of the words with a new recogniser, the other half after it, that one again.

    What a recogniser finds out while it reads may serve it with other words, or with the same only.
    """
    try:
        with time_limit(seconds):
            first, _ = _pass(fresh(subject).accepts, words[:1])
        half = max(1, affordable(first, rounds, seconds, len(words)) // 2)
        times = []
        for _ in range(rounds):
            ours = fresh(subject)
            passes = []
            for part in (words[:half], words[half : 2 * half], words[half : 2 * half]):
                with time_limit(5 * seconds):
                    taken, answers = _pass(ours.accepts, part)
                _must(subject, part, answers, truth=truth)
                passes.append(taken / max(1, len(part)))
            times.append(passes)
    except TimeUp:
        return Cell(failure=f"> {seconds:g} s")
    new, warm, again = (median(column) for column in zip(*times, strict=True))
    return Cell(seconds=new, warm=warm, again=again)


def measure_peer(
    subject: Subject,
    peer: Peer,
    words: Sequence[Word],
    others: Sequence[Word],
    rounds: int,
    seconds: float,
    *,
    truth: bool,
) -> Cell:
    """A library and ours in turn, on as many of the words as it has time for.

    ``others`` are words that ours has read before.
    """
    encoded = [peer.encode(word) for word in words]
    try:
        with time_limit(seconds):
            first, _ = _pass(peer.accepts, encoded[:1])
        count = affordable(first, rounds, seconds, len(words))
        both = words[:count], encoded[:count]
        return _paired(subject, peer, both, others, rounds, seconds, truth)
    except TimeUp:
        return Cell(failure=f"> {seconds:g} s")
    except Exception as error:
        return Cell(failure=type(error).__name__)


def _paired(
    subject: Subject,
    peer: Peer,
    words: tuple[Sequence[Word], Sequence[Any]],
    others: Sequence[Word],
    rounds: int,
    seconds: float,
    truth: bool,  # noqa: FBT001
) -> Cell:
    triples, wrong = [], []
    for _ in range(rounds):
        used = fresh(subject)
        with time_limit(5 * seconds):
            _pass(used.accepts, others)
            mine, answers = _pass(used.accepts, words[0])
            new, _ = _pass(fresh(subject).accepts, words[0])
        _must(subject, words[0], answers, truth=truth)
        with time_limit(2 * seconds):
            theirs, answers = _pass(peer.accepts, words[1])
        triples.append((mine, new, theirs))
        wrong = [w for w, answer in zip(words[0], answers, strict=True) if answer is not truth]
        if sum(map(sum, triples)) > seconds / 2:
            break
    return Cell(
        seconds=median(theirs for _, _, theirs in triples) / len(words[0]),
        ratio=median(theirs / mine for mine, _, theirs in triples),
        new_ratio=median(theirs / new for _, new, theirs in triples),
        wrong=tuple(wrong),
    )


def affordable(first: float, rounds: int, seconds: float, most: int) -> int:
    """How many words a round may have, from the time of one."""
    return max(1, min(most, int(seconds / SHARE / rounds / max(first, 1e-7))))


def _must(subject: Subject, words: Sequence[Word], answers: list[bool], *, truth: bool) -> None:
    for word, answer in zip(words, answers, strict=True):
        if answer is not truth:
            raise SystemExit(f"srgc is wrong on {subject.name}: {' '.join(word)}: {answer}")
