"""For which tasks the refutation of a robot covers its variants, and which words these have."""

from __future__ import annotations

from compiler.lemmas.conditioned_derivations import conditioned_derivations
from compiler.lemmas.embedding import are_variants
from compiler.lemmas.neutral_productions import NeutralProductions, neutral_productions
from compiler.lemmas.weighted import weights
from compiler.robots.normal_form import RobotFamily
from compiler.words.acceptance import accept_dfa
from compiler.words.derivation import Derivation
from compiler.words.finite_automaton import intersection
from grammar_lang import ir

NONE = NeutralProductions(frozenset(), frozenset())


def neutral_in_task(family: RobotFamily, task: ir.Task) -> NeutralProductions:
    """The productions of a family that are neutral for poses in a task.

    There are none if the start pose is given by coordinates, as a variant has others, or if values
    of the existing robot are kept, as these belong to other symbols in a variant.

    A variant must collide with everything that the refuted robot collides with. A shape hides the
    points and solids of its link, so no shape is added where bodies matter. Nothing is removable
    where there is a shape, because removing a joint makes two links one. If a robot must not touch
    itself, rods hide points and solids, too, and bodies of one link may touch: then only
    productions that emit nothing are added, and nothing is removable.
    """
    kept = task.origin is not None and bool(task.origin.fixed)
    if isinstance(task.start, ir.StartAt) or kept:
        return NONE
    found = neutral_productions(family.program, family.grammar)
    productions, blocks = family.grammar.productions, family.grammar.semantics or {}
    emitted = [blocks[each.label].emissions if each.label in blocks else () for each in productions]
    if task.avoid_self is not None:
        silent = frozenset(number for number in found.transparent if not emitted[number])
        return NeutralProductions(frozenset(), silent)
    if not task.bounds_body and all(clause.subject == "effector" for clause in task.avoid):
        return found
    shaped = {k for k, own in enumerate(emitted) if any(isinstance(e, ir.Shape) for e in own)}
    return NeutralProductions(
        frozenset() if shaped else found.removable, found.transparent - shaped
    )


def holds_of_variants(
    family: RobotFamily, task: ir.Task, base: Derivation, condition: ir.Accept
) -> bool:
    """Whether every derivation of every word with a condition is a variant of a derivation.

    Raises:
        ValueError: there are too many derivations to decide this.
    """
    language = family.language
    neutral = neutral_in_task(family, task)
    if neutral.none:
        return False
    dfa = intersection(language.accept, accept_dfa(condition, language.srg.terminals))
    derivations = conditioned_derivations(language.srg.cfg, dfa)
    return are_variants(derivations, base, family.grammar.productions, neutral)


def holds_of_weighted(
    family: RobotFamily, task: ir.Task, base: Derivation, condition: ir.Accept, most: int
) -> bool:
    """Whether each derivation of each word is the base with up to ``most`` weights per module.

    Raises:
        ValueError: there are too many derivations to decide this.
    """
    kinds = weights(family, task)
    if not kinds:
        return False
    productions = family.grammar.productions
    numbers = {production.label: number for number, production in enumerate(productions)}
    added = NeutralProductions(frozenset(), frozenset(numbers[label] for label in kinds))
    language = family.language
    symbols = language.srg.terminals
    dfa = intersection(language.accept, accept_dfa(condition, symbols))
    more = ir.AnyOf(tuple(ir.Count(name, ">", most) for name in dict.fromkeys(kinds.values())))
    beyond = conditioned_derivations(language.srg.cfg, intersection(dfa, accept_dfa(more, symbols)))
    if beyond.roots:
        return False
    derivations = conditioned_derivations(language.srg.cfg, dfa)
    return are_variants(derivations, base, productions, added)


def is_about_poses(boxes: str) -> bool:
    """Whether a covering is only about poses, not about drives or objectives."""
    return not {"!", "$"} & {*boxes}
