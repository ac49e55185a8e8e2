"""A request to ``srgc graph``, and the picture that it gives."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

from compiler.robots.attributes import SemanticsError
from compiler.views.family_views import family_dfa_view, grammar_view
from compiler.views.pushdown_views import sra_view
from compiler.views.words_view import all_words, longest_drawn, near_run, words_view
from compiler.views.workspace_view import (
    HighlightError,
    Picture,
    not_accepted,
    refuse_unknown,
    run_of,
)
from compiler.words.derivation import Derivation, replay
from compiler.words.deterministic_pushdown import deterministic_pushdown
from compiler.words.grammar import cyclic, trimmed
from compiler.words.language import Language, language
from compiler.words.lr_automaton import LrAutomaton, LrTooLarge
from compiler.words.pushdown_automaton import sra
from compiler.words.structures import derivations_of
from grammar_lang import ir
from srgc.faults import Argument, UsageFault, argument
from srgc.paths import write_output
from srgc.session import chosen

VIEWS = ("sra", "fra", "dfa", "dpda", "words", "grammar", "robot", "workspace")
WITH_RUNS = ("sra", "fra", "dfa", "dpda", "words", "grammar")
OF = argument("of")
NEAR = Argument("--near and --whole go", "`near` goes")
DEPTH = 3
MOST_TRANSITIONS = 20_000
MOST_WORDS = 5_000
MOST_WORDS_NEAR = 50_000
"""The number of words among which those near a run are sought; far fewer are drawn."""


@dataclass(frozen=True, slots=True)
class GraphRequest:
    """A view of a part of the program, with its choices; ``derivation`` counts from 1.

    Without a ``depth``, words are unfolded to ``DEPTH`` modules, or if ``near``, to the end of the
    run. With a ``highlight``, words are drawn only ``near`` its run, unless ``near`` is False.  A
    workspace is split into at least ``cells`` cells.
    """

    of: str
    grammar: str | None = None
    workspace: str | None = None
    depth: int | None = None
    highlight: tuple[str, ...] | None = None
    near: bool | None = None
    word: tuple[str, ...] | None = None
    derivation: int | None = None
    cells: int | None = None


@dataclass(frozen=True, slots=True)
class Drawing:
    """A picture, and remarks for the reader."""

    picture: Picture
    remarks: tuple[str, ...] = ()


def drawing_of(program: ir.Program, request: GraphRequest) -> Drawing:
    """Draw the picture that is asked for.

    Raises:
        UsageFault: the choices do not fit each other or the program.
    """
    _refuse_misfits(request)
    try:
        if request.of == "workspace":
            place = chosen(program.workspaces, request.workspace, "workspace")
            if place.maps:
                from compiler.tasks.obstacle_pieces import expanded_workspace

                place = expanded_workspace(place)
            # The other views do not need numpy.
            from compiler.views.workspace_view import workspace_view
            from compiler.workspaces.abstraction import abstract
            from compiler.workspaces.bisection import bisections

            partition = abstract(place)
            if request.cells is not None:
                partition = partition.cut(bisections(partition, request.cells))
            return Drawing(workspace_view(partition, place))
        grammar = chosen(program.grammars, request.grammar, "grammar")
        if request.of == "robot":
            return _robot(program, grammar, request)
        drawing = _family(program, grammar, request)
    except (HighlightError, SemanticsError) as error:
        raise UsageFault(str(error)) from None
    return Drawing(near_run(drawing.picture), drawing.remarks) if _near(request) else drawing


def _near(request: GraphRequest) -> bool:
    """Whether to draw only the run and its neighbours."""
    if request.near is None:
        return request.of == "words" and request.highlight is not None
    return request.near


def _refuse_misfits(request: GraphRequest) -> None:
    if request.of not in VIEWS:
        raise UsageFault(f"there is no view `{request.of}`, but {' '.join(VIEWS)}")
    if request.highlight is not None and request.of not in WITH_RUNS:
        raise UsageFault(
            argument("highlight"), " shows a run: it goes with ", OF, f" {' '.join(WITH_RUNS)}"
        )
    if request.near is not None and request.highlight is None:
        raise UsageFault(NEAR, " with ", argument("highlight"))
    if request.cells is not None and request.of != "workspace":
        raise UsageFault(argument("cells"), " goes with ", OF, " workspace")
    if request.depth is not None and request.of != "words":
        raise UsageFault(argument("depth"), " goes with ", OF, " words")
    if any(number is not None and number < 1 for number in (request.depth, request.derivation)):
        raise UsageFault(argument("depth"), " and ", argument("derivation"), " count from 1")
    if request.of == "robot" and request.word is None:
        raise UsageFault(OF, " robot needs the word: ", argument("word"), ' "SYM SYM ..."')
    if request.of != "robot" and (request.word is not None or request.derivation is not None):
        raise UsageFault(
            argument("word"), " and ", argument("derivation"), " go with ", OF, " robot"
        )


def _family(program: ir.Program, grammar: ir.Grammar, request: GraphRequest) -> Drawing:
    words = language(grammar, program.terminals, program.modules)
    match request.of:
        case "words":
            return _words(words, request)
        case "dfa":
            return Drawing(family_dfa_view(words, request.highlight))
        case "dpda":
            return Drawing(_deterministic(words, request.highlight))
        case "grammar":
            return Drawing(grammar_view(words, request.highlight))
        case "fra":
            from compiler.views.pushdown_views import functional_view

            if request.highlight is not None:
                _refuse_foreign(words, request.highlight)
            return Drawing(functional_view(program, grammar, request.highlight))
        case _:
            return Drawing(sra_view(sra(words.srg, words.accept), request.highlight))


def _deterministic(words: Language, highlight: tuple[str, ...] | None) -> Picture:
    """The deterministic pushdown automaton; its input ends with a marker."""
    found = words.lr_automaton
    if not isinstance(found, LrAutomaton):
        raise UsageFault(
            "the grammar is not LR(1): `srgc language` says where; there is ", OF, " sra"
        )
    pda = deterministic_pushdown(words.srg, found, words.accept, MOST_TRANSITIONS)
    if isinstance(pda, LrTooLarge):
        raise UsageFault("the deterministic pushdown automaton is too large to draw")
    if highlight is not None:
        _refuse_foreign(words, highlight)
    picture = sra_view(pda, None if highlight is None else (*highlight, pda.alphabet[-1]))
    nodes = tuple(replace(node, shape="ellipse") for node in picture.nodes)
    return replace(picture, name="dpda", shape="ellipse", nodes=nodes)


def _refuse_foreign(words: Language, word: tuple[str, ...]) -> None:
    refuse_unknown(word, words.srg.terminals)
    if not words.accepts(word):
        raise not_accepted(word)


def _words(words: Language, request: GraphRequest) -> Drawing:
    modules = sum(symbol in words.srg.modules for symbol in request.highlight or ())
    near = _near(request)
    depth = request.depth or (max(DEPTH, modules) if near else DEPTH)
    if request.highlight is not None:
        _refuse_foreign(words, request.highlight)
    _refuse_too_many(words, depth, near=near)
    remark = f"the word has {modules} modules: beyond --depth {depth} only its run is drawn"
    picture = words_view(words, depth, request.highlight)
    if not picture.nodes:
        return Drawing(picture, (f"no word has {depth} modules or fewer: give a greater --depth",))
    told = request.depth is not None and modules > depth
    return Drawing(picture, (remark,) if told else ())


def _refuse_too_many(words: Language, depth: int, *, near: bool) -> None:
    """Refuse a picture of thousands of words, which nobody can read and which is slow to write."""
    every = all_words(words.srg)
    most = MOST_WORDS_NEAR if near else MOST_WORDS
    for modules in range(1, depth + 1):
        longest = longest_drawn(every, modules)
        if sum(every.count_words(longest, max_modules=modules)) > most:
            raise UsageFault(
                f"more than {most} words to {'look through' if near else 'draw'}: choose a ",
                argument("depth"),
                f" below {modules}",
            )


def _robot(program: ir.Program, grammar: ir.Grammar, request: GraphRequest) -> Drawing:
    from compiler.robots.labelled_graph import labelled_graph
    from compiler.views.family_views import robot_view

    words = language(grammar, program.terminals, program.modules)
    found = chosen_derivation(words, grammar, request.word or (), request.derivation)
    return Drawing(robot_view(labelled_graph(program, grammar, found.derivation)), found.remarks)


# --- The derivation of a word ---------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class ChosenDerivation:
    """A derivation, and remarks for the reader."""

    derivation: Derivation
    remarks: tuple[str, ...]


def chosen_derivation(
    words: Language, grammar: ir.Grammar, word: tuple[str, ...], wanted: int | None
) -> ChosenDerivation:
    """The ``wanted``-th derivation of a word, counted from 1, or the first.

    Raises:
        UsageFault: the word is not in the family, or has fewer derivations.
    """
    try:
        refuse_unknown(word, words.srg.terminals)
        if not words.accepts(word):
            raise not_accepted(word)
        derivations = _derivations(words, grammar, word)
    except HighlightError as error:
        raise UsageFault(str(error)) from None
    number = wanted or 1
    first = list(islice(derivations, number))
    if len(first) < number:
        noun = "derivation" if len(first) == 1 else "derivations"
        raise UsageFault(
            f"the word has {len(first)} {noun}: there is no ", argument("derivation"), f" {number}"
        )
    remarks: tuple[str, ...] = ()
    if cyclic(trimmed(words.srg.cfg)):
        remarks = ("a nonterminal of the grammar derives itself: one derivation is shown",)
    elif wanted is None and next(derivations, None) is not None:
        remarks = ("the word has several derivations: --derivation 2 shows the next",)
    return ChosenDerivation(first[-1], remarks)


def _derivations(
    words: Language, grammar: ir.Grammar, word: tuple[str, ...]
) -> Iterator[Derivation]:
    """The derivations of a word; only one if there may be infinitely many."""
    if not cyclic(trimmed(words.srg.cfg)):
        return derivations_of(words, word)
    run = run_of(sra(words.srg, words.accept), word)
    return iter([replay(grammar, [step.label for step in run if step.label is not None])])


# --- ``srgc graph``: DOT files, drawn as pictures if Graphviz is installed ------------------------


DRAWN = (".svg", ".png", ".pdf")
TEXT = (".dot", ".gv", ".txt", "")
DRAWING_SECONDS = 120


def write_graph(text: str, output: Path) -> str:
    """Write DOT text, or the picture that the file name asks for; return Graphviz's messages.

    Raises:
        UsageFault: the file name has another suffix, Graphviz is needed and missing, or the file
            cannot be written.
    """
    suffix = output.suffix.lower()
    if suffix not in (*TEXT, *DRAWN):
        raise UsageFault(f"{output}: give a name that ends in {', '.join((*TEXT[:-1], *DRAWN))}")
    if suffix in TEXT:
        write_output(output, text)
        return ""
    picture, said = drawn_by_graphviz(text, suffix[1:])
    write_output(output, picture)
    return said


def drawn_by_graphviz(text: str, form: str) -> tuple[bytes, str]:
    """The picture of a DOT text as svg, png or pdf, and Graphviz's messages.

    Raises:
        UsageFault: Graphviz is missing, or fails.
    """
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
    said = finished.stderr.decode(errors="replace").strip()
    if finished.returncode:
        raise UsageFault(f"Graphviz failed: {said}")
    return finished.stdout, said
