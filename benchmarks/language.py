"""Measure language operations: the same words against libraries that a Python user has.

Six grammars, accepted and refused words of four lengths, every library that reads the grammar;
then wrong answers, each reproduced; then the first words of the paper's grammar.
"""

from __future__ import annotations

import argparse
import gc
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from statistics import median

from language_cells import (
    Cell,
    TimeUp,
    affordable,
    fresh,
    kind_of,
    measure_ours,
    measure_peer,
    time_limit,
    timed,
)
from language_enumeration import enumeration_lines
from language_grammars import Subject, Word, accepted, refused, subjects
from language_peer import NotApplicableError, Peer
from language_peers import PEERS, import_libraries
from language_traps import membership_traps, operation_traps, quoted
from timing import ROOT, machine

sys.path.insert(0, str(ROOT))  # brute force is among the tests' oracles
LENGTHS = (10, 50, 200, 1000)
SYMBOLS = 4000
"""So many symbols, about, are read at each length."""
HEADLINE = 200
"""The requirements are about words of this length."""


@dataclass(frozen=True)
class Required:
    """A ratio to be reached, against one library or the best that reads any grammar as it is."""

    what: str
    least: float
    grammars: tuple[str, ...]
    against: str | None


REQUIRED = (
    Required("finite automata", 8, ("paper", "right-linear"), "automata-lib DFA"),
    Required("deterministic pushdown automata", 8, ("branching", "matched"), "lark LALR"),
    Required("ambiguous", 8, ("ambiguous",), None),
    Required("chain with empty productions", 3, ("chain",), None),
)


@dataclass
class Table:
    """What was measured on one grammar: cells by (library, length, accepted)."""

    subject: Subject
    kind: str
    ours: float
    built: dict[str, float] = field(default_factory=dict)
    remarks: dict[str, str] = field(default_factory=dict)
    cells: dict[tuple[str, int, bool], Cell] = field(default_factory=dict)
    symbols: dict[int, int] = field(default_factory=dict)


OURS = "srgc"


def measure(subject: Subject, options: argparse.Namespace) -> Table:
    """All cells of a grammar."""
    built = median(timed(lambda: fresh(subject)) for _ in range(3))
    table = Table(subject, kind_of(fresh(subject)), built)
    peers = _build(table, options.peers, options.seconds)
    gc.collect()
    gc.freeze()  # so that collections between passes look at what the passes leave
    for truth in (True, False):
        stopped: dict[str, Cell] = {}
        for length in options.lengths:
            for name, cell in _measure_length(table, peers, stopped, length, truth, options):
                table.cells[name, length, truth] = cell
    gc.unfreeze()
    return table


def _measure_length(
    table: Table,
    peers: Sequence[Peer],
    stopped: dict[str, Cell],
    length: int,
    truth: bool,  # noqa: FBT001
    options: argparse.Namespace,
) -> Iterator[tuple[str, Cell]]:
    """The cells of a column; a library that failed is not asked again about longer words."""
    limits = options.rounds, options.seconds
    words = _words(table, length, truth=truth)
    ours = measure_ours(table.subject, words, *limits, truth=truth)
    yield OURS, ours
    half = (len(words) + 1) // 2
    words, others = words[:half], words[half:]
    if ours.seconds is None:
        yield from ((peer.name, Cell(failure="not tried")) for peer in peers)
        return
    words = words[: affordable(ours.seconds, *limits, len(words))]
    for peer in peers:
        cell = stopped.get(peer.name)
        if cell is None:
            cell = measure_peer(table.subject, peer, words, others, *limits, truth=truth)
        if cell.failure:
            stopped[peer.name] = cell
        yield peer.name, cell


def _build(table: Table, kinds: Sequence[type[Peer]], seconds: float) -> list[Peer]:
    """The recognisers that can be had, and why the others cannot."""
    import_libraries(kinds)
    found = []
    for kind in kinds:
        try:
            with time_limit(5 * seconds):
                peers: list[Peer] = []
                table.built[kind.name] = timed(
                    lambda k=kind, p=peers: p.append(k(table.subject.grammar))
                )
            table.remarks[kind.name] = peers[0].remark()
            found += peers
        except NotApplicableError as error:
            table.remarks[kind.name] = f"does not apply: {error}"
        except TimeUp:
            table.remarks[kind.name] = f"not built in {5 * seconds:g} s"
    return found


def _words(table: Table, length: int, *, truth: bool) -> list[Word]:
    count = 2 * max(16, min(200, SYMBOLS // length))
    words = (accepted if truth else refused)(table.subject, length, count)
    if truth:
        table.symbols[length] = len(words[0])
    return words


# --- report ---------------------------------------------------------------------------------------


def table_lines(table: Table, lengths: Sequence[int], kinds: Sequence[type[Peer]]) -> Iterator[str]:
    """Two blocks, accepted and refused; each cell the time of a word, and how many times ours."""
    yield f"{table.subject.name}: {table.subject.what}"
    yield f"srgc reads it with: {table.kind}"
    names = [kind.name for kind in kinds if kind.name in table.built]
    for truth in (True, False):
        heads = "".join(f"{f'{table.symbols[n]} symbols':>20}" for n in lengths)
        yield f"{'accepted' if truth else 'refused':<22}{'build ms':>9}{heads}"
        yield from _our_lines(table, [table.cells[OURS, n, truth] for n in lengths])
        for name in names:
            cells = "".join(_cell(table.cells[name, n, truth]) for n in lengths)
            yield f"{name:<22}{table.built[name] * 1e3:>9.2f}{cells}".rstrip()
    for name, remark in table.remarks.items():
        if remark:
            yield f"{name}: {remark}"


def _our_lines(table: Table, cells: Sequence[Cell]) -> Iterator[str]:
    rows = {
        f"srgc, new{table.ours * 1e3:>22.2f}": [
            cell.failure or _time(cell.seconds) for cell in cells
        ],
        "srgc, after other words": [_time(cell.warm) for cell in cells],
        "srgc, the same again": [_time(cell.again) for cell in cells],
    }
    for name, times in rows.items():
        yield f"{name:<31}{''.join(f'{text:>12}{str():8}' for text in times)}".rstrip()


def _cell(cell: Cell) -> str:
    if cell.failure:
        return f"{cell.failure:>12}{'':8}" if len(cell.failure) < 12 else f"{cell.failure:>20}"
    mark = " !" if cell.wrong else ""
    ratio = "" if cell.ratio is None else f"{_ratio(cell.ratio)}{mark}"
    return f"{_time(cell.seconds):>12}{ratio:>8}"


def _time(seconds: float | None) -> str:
    if seconds is None:
        return ""
    for unit, size in (("s", 1.0), ("ms", 1e-3)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds * 1e6:.3g} us"


def _ratio(ratio: float) -> str:
    return f"{ratio:,.0f}x" if ratio >= 100 else f"{ratio:.1f}x"


def summary_lines(tables: Sequence[Table], seconds: float) -> Iterator[str]:
    """The required ratios; words of 200 symbols, then the least of all lengths."""
    for required in REQUIRED:
        for table in (t for t in tables if t.subject.name in required.grammars):
            for truth in (True, False):
                what = f"{table.subject.name}, {'accepted' if truth else 'refused'}"
                found = _headline(table, required, seconds, truth=truth)
                yield f"{required.what:<33}{what:<24}at least {required.least}: {found}"


def _headline(table: Table, required: Required, seconds: float, *, truth: bool) -> str:
    lengths = sorted(table.symbols)
    ratios = {n: _best(table, required, n, seconds, truth=truth) for n in lengths}
    length = min(lengths, key=lambda n: abs(n - HEADLINE))
    value, name = ratios[length]
    if value is None:
        return "not measured"
    new = table.cells[name, length, truth].new_ratio if name in table.built else None
    verdict = "reached" if value >= required.least else "NOT REACHED"
    known = {n: ratio for n, (ratio, _) in ratios.items() if ratio is not None}
    worst = min(known, key=known.__getitem__)
    first = f", {_ratio(new)} by a new recogniser" if new else ""
    return (
        f"{_ratio(value):>8} at {table.symbols[length]} symbols against {name}{first}, {verdict}"
        f"; least {_ratio(known[worst])} at {table.symbols[worst]}"
        f"{_aside(table, required, length, truth=truth)}"
    )


def _aside(table: Table, required: Required, length: int, *, truth: bool) -> str:
    """LALR tables without the conflicts: quick, and no reading of the grammar as it is."""
    name = "lark LALR"
    cell = table.cells.get((name, length, truth))
    if required.against is not None or cell is None or cell.ratio is None:
        return ""
    if any(other.wrong for key, other in table.cells.items() if key[0] == name):
        return f"; {name} answers wrongly"
    return f"; {name}, conflicts resolved, {_ratio(cell.ratio)}"


def _best(
    table: Table, required: Required, length: int, seconds: float, *, truth: bool
) -> tuple[float | None, str]:
    """The ratio to the quickest of the libraries that count, and which that is."""
    fair = {kind.name for kind in PEERS if kind.any_grammar}
    fair = fair if required.against is None else {required.against}
    cells = {n: table.cells[n, length, truth] for n in fair & set(table.built)}
    right = {n: c.seconds for n, c in cells.items() if c.seconds is not None and not c.wrong}
    if right:
        name = min(right, key=right.__getitem__)
        return cells[name].ratio, name
    ours = table.cells[OURS, length, truth].seconds
    if not cells or ours is None:
        return None, ""
    return seconds / ours, f"none that ends within {seconds:g} s"


def wrong_lines(tables: Sequence[Table], options: argparse.Namespace) -> Iterator[str]:
    """Wrong answers among the measured words, then those of the traps."""
    for table in tables:
        for name in table.built:
            wrong = {t: _wrong(table, name, truth=t) for t in (True, False)}
            for truth, words in wrong.items():
                if words:
                    said = "refuses" if truth else "accepts"
                    more = f", and {len(words) - 1} more" if len(words) > 1 else ""
                    yield f"{name:<20}{table.subject.name}: {said} {quoted(words[0])}{more}"
            failures = {c.failure for key, c in table.cells.items() if key[0] == name}
            for failure in sorted(f for f in failures if f.endswith("Error")):
                yield f"{name:<20}{table.subject.name}: {failure}"
    yield from membership_traps(options.peers, options.seconds / 4)
    yield from operation_traps(options.seconds)


def _wrong(table: Table, name: str, *, truth: bool) -> list[Word]:
    cells = [c for key, c in table.cells.items() if (key[0], key[2]) == (name, truth)]
    return [word for cell in cells for word in cell.wrong]


# --- command line ---------------------------------------------------------------------------------


def options_of(arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line, with subjects and libraries in place of their names."""
    subjects_by_name = {subject.name: subject for subject in subjects()}
    kinds = {kind.name: kind for kind in PEERS}
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--grammars", nargs="+", choices=subjects_by_name, metavar="NAME")
    parser.add_argument("--lengths", type=int, nargs="+", default=LENGTHS)
    parser.add_argument("--peers", nargs="+", choices=kinds, metavar="NAME")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=2.0, help="limit for a single word")
    parser.add_argument(
        "--only-membership", action="store_true", help="no wrong answers, no enumeration"
    )
    options = parser.parse_args(arguments)
    if options.rounds < 1 or options.seconds <= 0 or min(options.lengths) < 3:
        parser.error("rounds and seconds are positive, lengths at least 3")
    options.lengths = tuple(sorted(set(options.lengths)))
    options.grammars = [subjects_by_name[name] for name in options.grammars or subjects_by_name]
    options.peers = [kinds[name] for name in options.peers or kinds]
    return options


def main() -> None:
    """Measure and print."""
    options = options_of()
    print(machine())
    tables = []
    for subject in options.grammars:
        tables.append(measure(subject, options))
        print()
        for line in table_lines(tables[-1], options.lengths, options.peers):
            print(line, flush=True)
    if not options.only_membership:
        print("\nwrong answers, and none")
        for line in wrong_lines(tables, options):
            print(line, flush=True)
        print()
        for line in enumeration_lines(5 * options.seconds):
            print(line, flush=True)
    print("\nrequired")
    for line in summary_lines(tables, options.seconds):
        print(line, flush=True)


if __name__ == "__main__":
    main()
