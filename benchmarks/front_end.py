"""Measure the front end: the cold start of ``check``, and its throughput on large files.

Each is compared with lark in the same run: with its import, and with its bare LALR parse of the
same text (contextual lexer, no positions), which makes nothing of what it reads.
"""

from __future__ import annotations

import argparse
import gc
import math
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from statistics import linear_regression, median

from large_spec import large_spec
from timing import HEAD, ROOT, SPEC, SRGC, Line, machine, process, summary

from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.formatting.formatter import canonical
from grammar_lang.load import load_text
from grammar_lang.parsing.parse import parse
from srgc.session import check_loaded

MEGABYTE = 2**20
SIZES = (0.25, 0.5, 1.0, 2.0)
LARK = "lark, bare parse"
STAGES = (LARK, "parse", "load", "check", "format")


def measure_cold_start(runs: int) -> list[Line]:
    """``check`` against the import of lark, which a checker with its parser could not undercut."""
    lark, check = [], []
    for _ in range(runs + 1):
        lark.append(process([sys.executable, "-c", "import lark"]))
        check.append(process([*SRGC, "check", str(SPEC)]))
    del lark[0], check[0]  # the first round compiles, and fills the cache of the disk
    ratio = median(b.wall / a.wall for a, b in zip(lark, check, strict=True))
    return [
        summary("python -c 'import lark'", lark),
        summary("srgc check", check, f"{ratio:.2f} times the line above"),
    ]


def _lark_parser() -> Callable[[str], object]:
    from lark import Lark

    rules = (ROOT / "grammar_lang" / "parsing" / "srg.lark").read_text(encoding="utf-8")
    grammar = f"file: item*\n{rules}"
    return Lark(grammar, start="file", parser="lalr", lexer="contextual").parse


def _checked(text: str) -> None:
    found = check_loaded(load_text(text, "large.srg"))
    if found.diagnostics:
        raise SystemExit(f"the generated file is not sound: {found.diagnostics[0]}")


def _parsed(text: str) -> None:
    sink = Sink()
    parse(text, sink)
    if sink.found:
        raise SystemExit("the generated file has syntax errors")


def _formatted(text: str) -> None:
    if canonical(text, Sink()) is None:
        raise SystemExit("the generated file has syntax errors")


def _collected(action: Callable[[str], object], text: str) -> float:
    """The processor time of a call that does not pay for the rubbish of the one before."""
    gc.collect()
    started = time.process_time()
    action(text)
    return time.process_time() - started


def measure_throughput(sizes: tuple[float, ...], rounds: int) -> list[str]:
    """Processor time per size and stage, all stages in turn, and how it grows."""
    actions: Mapping[str, Callable[[str], object]] = {
        LARK: _lark_parser(),
        "parse": _parsed,
        "load": lambda text: load_text(text, "large.srg"),
        "check": _checked,
        "format": _formatted,
    }
    texts = {size: large_spec(int(size * MEGABYTE)) for size in sizes}
    times: dict[tuple[str, float], list[float]] = {}
    for action in actions.values():
        action(texts[sizes[0]])
    for _ in range(rounds):
        for size in sizes:
            for stage, action in actions.items():
                times.setdefault((stage, size), []).append(_collected(action, texts[size]))
    return [
        _heading(sizes),
        *(_row(stage, texts, times) for stage in STAGES),
        f"check against {LARK}, in lines per second: "
        + ", ".join(f"{_ratio(times, size):.2f} at {size:g} MB" for size in sizes),
    ]


def _heading(sizes: tuple[float, ...]) -> str:
    columns = "".join(f"{f'{size:g} MB':>10}" for size in sizes)
    return f"{'cpu s of':<20}{columns}{'exponent':>10}{'lines/s':>10}"


def _row(
    stage: str, texts: Mapping[float, str], times: Mapping[tuple[str, float], list[float]]
) -> str:
    medians = {size: median(times[stage, size]) for size in texts}
    columns = "".join(f"{value:>10.2f}" for value in medians.values())
    largest = max(texts)
    speed = texts[largest].count("\n") / medians[largest]
    slope = "" if len(texts) < 2 else f"{_exponent(texts, medians):.2f}"
    return f"{stage:<20}{columns}{slope:>10}{speed:>10,.0f}"


def _exponent(texts: Mapping[float, str], medians: Mapping[float, float]) -> float:
    """The slope of the logarithm of the time over that of the size: 1 where time is linear."""
    sizes = [math.log(len(texts[size])) for size in texts]
    return linear_regression(sizes, [math.log(medians[size]) for size in texts]).slope


def _ratio(times: Mapping[tuple[str, float], list[float]], size: float) -> float:
    """Lines per second of the whole check by those of lark, per round."""
    pairs = zip(times[LARK, size], times["check", size], strict=True)
    return median(lark / check for lark, check in pairs)


def main() -> None:
    """Measure and print two tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=15, help="of the cold start")
    parser.add_argument("--rounds", type=int, default=3, help="of the large files")
    parser.add_argument("--sizes", type=float, nargs="+", default=SIZES, help="in megabytes")
    parser.add_argument("--write", type=Path, help="write the largest of the files here, and stop")
    options = parser.parse_args()
    if options.runs < 1 or options.rounds < 1 or min(options.sizes) <= 0:
        parser.error("runs, rounds and sizes are positive")
    sizes = tuple(sorted(options.sizes))
    if options.write is not None:
        options.write.write_text(large_spec(int(sizes[-1] * MEGABYTE)), encoding="utf-8")
        return
    print(machine())
    print(HEAD, flush=True)
    for line in measure_cold_start(options.runs):
        print(line, flush=True)
    print()
    for text in measure_throughput(sizes, options.rounds):
        print(text, flush=True)


if __name__ == "__main__":
    main()
