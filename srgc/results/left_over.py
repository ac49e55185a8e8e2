"""``srgc graph DIR --of lemmas``: the words of a family that the lemmas of a result leave."""

from __future__ import annotations

from pathlib import Path

from compiler.robots.normal_form import family_of
from compiler.views.family_views import dfa_view
from compiler.views.pushdown_views import sra_view
from compiler.views.workspace_view import Picture
from compiler.words.acceptance import at_most
from compiler.words.finite_automaton import intersection
from compiler.words.language import Language, restrict
from compiler.words.pushdown_automaton import sra
from grammar_lang import ir
from grammar_lang.conditions import condition_of
from srgc.faults import UsageFault
from srgc.graphs.graph_request import Drawing
from srgc.results.why_folder import tried_folder

NAMED = 2
"""The number of conditions to name in a remark."""


def drawing_of_lemmas(folder: Path) -> Drawing:
    """The automaton of the words of a result's family that no lemma covers.

    It is finite if the form of the grammar shows that a finite one exists, else a pushdown
    automaton; words have at most as many modules as the task allows.

    Raises:
        UsageFault: the folder has no results, or the results have no lemmas.
    """
    if folder.is_file():
        raise UsageFault(f"{folder} is a file: the lemmas are in the folder of a result")
    tried = tried_folder(folder)
    posed, claims = tried.posed, tried.lemmas
    if not claims:
        raise UsageFault(f"{folder} has no lemmas")
    symbols = posed.program.terminals
    covered = tuple(condition_of(claim.condition, symbols) for claim in claims)
    family = family_of(posed.program, posed.task)
    words = family.with_condition(ir.NotAccept(ir.AnyOf(covered))).language
    bound = posed.task.modules
    if bound is not None:
        within = at_most(symbols, words.srg.modules, bound)
        words = restrict(words.srg, intersection(words.accept, within))
    return Drawing(_picture(words), _remarks(words, [claim.condition for claim in claims]))


def _picture(words: Language) -> Picture:
    """The automaton of a language."""
    if words.finite_automaton is not None:
        return dfa_view(words.finite_automaton, "words that no lemma is about")
    return sra_view(sra(words.srg, words.accept))


def _remarks(words: Language, conditions: list[str]) -> tuple[str, ...]:
    said = "; ".join(f"`{condition}`" for condition in conditions[:NAMED])
    more = len(conditions) - NAMED
    said += f"; and {more} more" if more > 0 else ""
    if words.is_empty():
        return (f"nothing is left: all words satisfy the condition of a lemma ({said})",)
    first = " ".join(words.shortest_word() or ()) or "the empty word"
    return (f"left by {said}: the first word is {first}",)
