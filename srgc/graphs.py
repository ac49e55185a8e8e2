"""``srgc graph``: views as DOT, drawn as SVG or PNG where Graphviz is installed."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from compiler.automata.acceptance import accept_dfa
from compiler.automata.pushdown_automaton import sra
from compiler.geometry.abstraction import abstract
from compiler.languages.language import Language, language, restrict
from compiler.views.automaton_dot import dfa_dot, grammar_dot, sra_dot, words_dot
from compiler.views.workspace_dot import workspace_dot
from grammar_lang import ir
from srgc.session import UsageFault, chosen

DRAWN = (".svg", ".png")
DRAWING_SECONDS = 120
MOST_WORDS = 5000


def dot_text(
    program: ir.Program, what: str, grammar: str | None, workspace: str | None, depth: int
) -> str:
    """The DOT text of a view.

    Raises:
        UsageFault: a grammar or workspace has to be chosen.
    """
    if what == "workspace":
        place = chosen(program.workspaces, workspace, "workspace")
        return workspace_dot(abstract(place), place)
    family = chosen(program.grammars, grammar, "grammar")
    words = language(family, program.terminals, program.modules)
    if what == "words":
        _refuse_too_many(words, depth)
        return words_dot(words, depth)
    if what == "dfa":
        return dfa_dot(words.accept)
    if what == "grammar":
        return grammar_dot(words.srg)
    return sra_dot(sra(words.srg, words.accept))


def _refuse_too_many(words: Language, depth: int) -> None:
    """A picture of thousands of words helps nobody and takes long to write."""
    every = restrict(words.srg, accept_dfa(ir.AllOf(()), words.srg.terminals))
    for modules in range(1, depth + 1):
        if not every.is_finite(max_modules=modules):
            return
        if sum(every.count_words(max_modules=modules)) > MOST_WORDS:
            raise UsageFault(
                f"more than {MOST_WORDS} words to draw: choose a --depth below {modules}"
            )


def write_graph(text: str, output: Path) -> None:
    """Write DOT text, or the picture its file name asks for.

    Raises:
        UsageFault: Graphviz is needed and missing, or the file cannot be written.
    """
    try:
        if output.suffix not in DRAWN:
            output.write_text(text, encoding="utf-8")
            return
        output.write_bytes(_drawn(text, output.suffix[1:]))
    except OSError as error:
        raise UsageFault(f"{output}: {error.strerror}") from None


def _drawn(text: str, form: str) -> bytes:
    program = shutil.which("dot")
    if program is None:
        raise UsageFault("Graphviz (`dot`) is not installed: write a .dot file instead")
    try:
        finished = subprocess.run(  # noqa: S603  (the program found above, fixed arguments)
            [program, f"-T{form}"],
            input=text.encode(),
            capture_output=True,
            timeout=DRAWING_SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise UsageFault(f"Graphviz did not finish within {DRAWING_SECONDS} s") from None
    if finished.returncode:
        raise UsageFault(f"Graphviz failed: {finished.stderr.decode(errors='replace').strip()}")
    return finished.stdout
