"""The conclusions from a mission's evidence: that no robots do it, or that none do it for less.

One robot: every word satisfies a lemma or is listed, and each derivation of a listed word is
refuted in some task, as a whole or box by box. Rebuilt robots: the cheapest chain of robots that
are not refuted is a lower bound on the cost of any robots.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice

from compiler.missions.chains import ChainCosts, Link, cheapest_chain
from compiler.missions.open_layers import OpenRobots, fixes, open_links
from compiler.missions.parameter_boxes import BoxTree
from compiler.missions.robot_changes import Built
from compiler.objectives.least_values import Amount
from compiler.robots.normal_form import RobotFamily
from compiler.words.structures import structures, structures_of
from grammar_lang import ir
from solvers.verifier.claims.mission_claim import MissionClaim
from solvers.verifier.missions.refuted_robots import Labels, RefutedRobots, tree_of
from solvers.verifier.refutations.structure_evidence import FalseClaim
from solvers.verifier.refutations.word_coverage import (
    Reader,
    listed,
    reader,
    weighing,
    within,
    word_left,
)

MOST_ROBOTS = 1000
"""The most structures that are compared with each other, as in the search."""


# --- One robot ------------------------------------------------------------------------------------


def no_one_robot(
    claim: MissionClaim,
    robots: Sequence[RefutedRobots],
    modules: int | None,
    limits: Sequence[tuple[Amount, Fraction]] = (),
    less: tuple[Amount, Fraction] | None = None,
) -> None:
    """Check that no robot does all tasks, within the limits and with less of an amount.

    Args:
        claim: the claim.
        robots: what is refuted in each task.
        modules: a bound on the modules of robots; None for no bound.
        limits: amounts, and the most that robots may have of each.
        less: an amount and a value; robots have less than this value. None: all robots.

    Raises:
        FalseClaim: this is not proved.
    """
    family = robots[0].family
    trees = {
        boxes.derivation: tree_of(boxes, robots) for boxes in claim.boxes if boxes.task is None
    }
    words = dict.fromkeys(
        [
            *(each.word for task in claim.tasks for each in task.structures),
            *(boxes.word for boxes in claim.boxes),
        ]
    )
    asked = [reader(family.grammar.accept), reader(ir.Count(None, ">=", 1))]
    if modules is not None:
        asked.append(within(family.program.modules, modules))
    asked += [weighing(amount.weights, most, strict=False) for amount, most in limits]
    if less is not None:
        asked.append(weighing(less[0].weights, less[1], strict=True))
    covered: list[Reader] = [each for task in robots for each in task.readers]
    covered.append(listed(words))
    if word_left(family.grammar, asked, covered):
        raise FalseClaim("there are words that no lemma and no structure is about")
    for word in words:
        if _is_meant(word, limits, less) and not any(each.has_lemma(word) for each in robots):
            _check_word(word, family, robots, trees)


def _is_meant(
    word: Sequence[str],
    limits: Sequence[tuple[Amount, Fraction]],
    less: tuple[Amount, Fraction] | None,
) -> bool:
    within_limits = all(amount.of_word(word) <= most for amount, most in limits)
    return within_limits and (less is None or less[0].of_word(word) < less[1])


def _check_word(
    word: tuple[str, ...],
    family: RobotFamily,
    robots: Sequence[RefutedRobots],
    trees: dict[Labels, BoxTree],
) -> None:
    """Check that each derivation of a word is refuted in some task."""
    for derivation in structures_of(family.language, [word]):
        tree = trees.get(derivation.labels)
        if tree is not None and tree.is_refuted:
            continue
        if not any(each.is_refuted(derivation) for each in robots):
            raise FalseClaim(f"{' '.join(word)} is refuted in no task")


# --- Robots that are rebuilt ----------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class LeftRobots:
    """The modules of each robot in the cheapest chain that is not refuted, and its least cost."""

    cost: Fraction
    robots: tuple[tuple[str, ...], ...]


def least_cost(
    mission: ir.Mission,
    prices: ir.Prices,
    robots: Sequence[RefutedRobots],
    existing: Built | None,
    modules: int | None,
) -> Fraction | None:
    """A lower bound on the cost of any chain of robots not refuted; None if there is no such chain.

    Raises:
        FalseClaim: there are too many structures, or infinitely many, to compare them.
    """
    left = cheapest_left(mission, prices, robots, existing, modules)
    return None if left is None else left.cost


def cheapest_left(
    mission: ir.Mission,
    prices: ir.Prices,
    robots: Sequence[RefutedRobots],
    existing: Built | None,
    modules: int | None,
) -> LeftRobots | None:
    """The cheapest chain of robots that are not refuted; None if there is no such chain.

    Raises:
        FalseClaim: there are too many structures, or infinitely many, to compare them.
    """
    first = robots[0]
    language, bounds = first.family.language, [each.task.modules for each in robots]
    known = [bound for bound in bounds if bound is not None]
    if len(known) < len(bounds):
        if not language.is_finite():
            raise FalseClaim("the language is infinite and a task has no bound on modules")
        most = len(language.count_words()) - 1
    else:
        most = max(known)
    if modules is not None and modules < most:
        raise FalseClaim("the bound on modules is not that of the tasks")
    found = list(islice(structures(language, most), MOST_ROBOTS + 1))
    if len(found) > MOST_ROBOTS:
        raise FalseClaim(f"there are more than {MOST_ROBOTS:,} structures")
    given = None if existing is None else Link(existing, narrow=True)
    costs = ChainCosts(prices, mission.free, given)
    layers = [
        open_links(
            found,
            first.program.modules,
            OpenRobots(
                each.task.modules,
                each.is_refuted,
                each.trees,
                each.model,
                fixed=fixes(each.task) or (each is first and existing is not None),
            ),
        )
        for each in robots
    ]
    chain = cheapest_chain(costs, layers)
    if chain is None:
        return None
    return LeftRobots(
        chain.cost,
        tuple(layer[i].names for layer, i in zip(layers, chain.robots, strict=True)),
    )
