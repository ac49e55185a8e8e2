"""Checks of tasks that need the language of the robot family."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from compiler.robots.effector_counts import several_effectors
from compiler.words.acceptance import accept_dfa
from compiler.words.finite_automaton import AutomatonTooLargeError, Dfa, intersection
from compiler.words.grammar import Srg, alphabet_of, srg
from compiler.words.intersection import CHECKED_RULES, BinaryGrammar, IntersectionTooLargeError
from compiler.words.language import Language, restrict
from compiler.words.recogniser import viable_prefix
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.ir.formula_parts import subformulas


def task_diagnostics(program: ir.Program, sink: Sink) -> None:
    """Report clauses that lack an effector number, and existing robots outside the family."""
    several: dict[str, bool | None] = {}
    for task in program.tasks.values():
        plain = list(_plain_atoms(task))
        loads: list[ir.Payload | ir.Carry] = [*task.payloads, *task.carries]
        carried = [each for each in loads if each.effector is None]
        if (plain or carried) and task.grammar not in several:
            several[task.grammar] = several_effectors(program, program.grammars[task.grammar])
        if several.get(task.grammar):
            for each in carried:
                place = "mass" if isinstance(each, ir.Payload) else "regions"
                sink.error(
                    Code.BAD_VALUE,
                    f"which effector carries it? a robot of `{task.grammar}` may have several",
                    each.span,
                    f"write `by effector 1` after the {place}",
                )
            for atom in plain:
                sink.error(
                    Code.BAD_VALUE,
                    f"which effector is in `{atom.region}`? "
                    f"a robot of `{task.grammar}` may have several",
                    atom.span,
                    f"write `{atom.region} by effector 1`",
                )
        if task.origin is not None:
            _origin(program, task, task.origin, sink)


def _plain_atoms(task: ir.Task) -> Iterator[ir.Atom]:
    for clause in task.satisfy:
        for node in subformulas(clause.formula):
            if isinstance(node, ir.Atom) and not node.numbered:
                yield node


def _origin(program: ir.Program, task: ir.Task, origin: ir.Origin, sink: Sink) -> None:
    """Report an existing robot that the family lacks, ignoring its accept condition."""
    rules = srg(program.grammars[task.grammar], program.terminals, program.modules)
    language = restrict(rules, accept_dfa(ir.AllOf(()), rules.terminals))
    if not language.accepts(origin.word):
        sink.error(
            Code.BAD_VALUE,
            f"the existing robot is not a word of grammar `{task.grammar}`",
            origin.span,
            _where_it_fails(language, origin.word),
        )


def _where_it_fails(language: Language, word: tuple[str, ...]) -> str:
    length = viable_prefix(language.normal, language.srg.terminals, word)
    if length < len(word):
        return f"no word of the grammar begins with `{' '.join(word[: length + 1])}`"
    return "this is only the beginning of a word: continue with more modules"


# --- Whether a family has robots that can start at the coordinates that a task gives --------------
#
# ``start at`` gives one value for each degree of freedom of the word, so this is a question about
# words: L(SRG), its accept condition and an automaton that counts degrees of freedom are
# intersected.


WRITTEN_AS = {"revolute": "an angle", "prismatic": "a length"}
"""The name of a value with a unit, by the kind of joint that it is for."""
UNITS = {"revolute": "`deg` or `rad`", "prismatic": "`m` or `cm`"}


def start_diagnostics(program: ir.Program, sink: Sink) -> None:
    """Report the tasks that give coordinates which no robot of their family has.

    An error if the values are of other kinds than the joints, a warning if there are too many or
    too few. A language that is too large to compute is skipped.
    """
    order = {name: i for i, name in enumerate(program.terminals)}
    for task in program.tasks.values():
        if isinstance(task.start, ir.StartAt):
            grammar = program.grammars[task.grammar]
            rules = srg(grammar, alphabet_of(grammar, order), program.modules)
            try:
                accept = accept_dfa(grammar.accept, rules.terminals)
                _Starting(program, task, task.start, rules, accept).report(sink)
            except (AutomatonTooLargeError, IntersectionTooLargeError):
                continue


@dataclass(frozen=True)
class _Starting:
    """A task that gives coordinates, and the words of its family."""

    program: ir.Program
    task: ir.Task
    start: ir.StartAt
    rules: Srg
    accept: Dfa

    @cached_property
    def family(self) -> BinaryGrammar:
        """All words of the family."""
        return restrict(self.rules, self.accept, CHECKED_RULES).product

    @cached_property
    def count(self) -> int:
        """The number of values given."""
        return len(self.start.values)

    def report(self, sink: Sink) -> None:
        """Report why no robot fits; an empty family is reported with its grammar."""
        kinds = [self.start.kind(i) for i in range(self.count)]
        fitting = self.words(kinds)
        if fitting.starts:
            self.bound(fitting, sink)
        elif self.words([None] * self.count).starts:
            self.kinds(kinds, sink)
        elif self.family.starts:
            self.number(sink)

    def words(self, kinds: Sequence[ir.DofKind | None]) -> BinaryGrammar:
        """The accepted words with degrees of freedom of these kinds; None means any kind."""
        counter = _counting(self.program, self.rules.terminals, kinds)
        fits = intersection(self.accept, counter)
        return restrict(self.rules, fits, CHECKED_RULES).product

    def kinds(self, kinds: Sequence[ir.DofKind | None], sink: Sink) -> None:
        """Report a value that is of the wrong kind in every robot with this many values."""
        bad, others = self.wrong(kinds)
        written = kinds[bad] or "revolute"
        met = "prismatic" if written == "revolute" else "revolute"
        sink.error(
            Code.UNIT_MISMATCH,
            f"value {bad + 1} is {WRITTEN_AS[written]}, but that degree of freedom is {met} in "
            f"every robot of `{self.task.grammar}` with {self.degrees}{others}",
            self.start.places[bad] if self.start.places else self.start.span,
            f"write {WRITTEN_AS[met]}, in {UNITS[met]}; values are in the order of the word",
            [(self.start.span, "the start that no robot can take")],
        )

    def wrong(self, kinds: Sequence[ir.DofKind | None]) -> tuple[int, str]:
        """A value, from 0, that fits no word together with those before it, and a condition."""
        low, high = 0, self.count - 1
        while low < high:
            middle = (low + high) // 2
            if self.words([*kinds[: middle + 1], *[None] * (self.count - middle - 1)]).starts:
                low = middle + 1
            else:
                high = middle
        alone = [kind if i == low else None for i, kind in enumerate(kinds)]
        if self.words(alone).starts:
            return low, " that the values before it fit"
        return low, ""

    def number(self, sink: Sink) -> None:
        """Report too many values, or too few."""
        modules = [self.program.modules.get(name) for name in self.rules.terminals]
        weights = [0 if module is None else len(module.dofs) for module in modules]
        fewest = self.family.lightest(weights) or 0
        hint = "give one value for each degree of freedom of the word"
        if self.count < fewest:
            hint += f": every robot has {fewest} or more"
        sink.warning(
            Code.START_OF_NO_ROBOT,
            f"no robot of `{self.task.grammar}` has {self.degrees}",
            self.start.span,
            f"{hint}; as it is, `synth` finds none",
        )

    def bound(self, fitting: BinaryGrammar, sink: Sink) -> None:
        """Report that all fitting robots are larger than the task allows."""
        if self.task.modules is None:
            return
        weights = [int(name in self.program.modules) for name in self.rules.terminals]
        fewest = fitting.lightest(weights) or 0
        smallest = self.family.lightest(weights) or 0
        # If no robot at all is that small, this is reported with the grammar.
        if smallest <= self.task.modules < fewest:
            sink.warning(
                Code.START_OF_NO_ROBOT,
                f"no robot of `{self.task.grammar}` that can start so has at most "
                f"{self.task.modules} modules",
                self.start.span,
                f"write `modules <= {fewest}` or more; with this bound `synth` answers impossible",
                [(self.task.clauses.get("modules", self.task.span), "the bound")],
            )

    @property
    def degrees(self) -> str:
        """The number of values, as degrees of freedom."""
        return "1 degree of freedom" if self.count == 1 else f"{self.count} degrees of freedom"


def dof_counter(program: ir.Program, alphabet: tuple[str, ...], start: ir.StartAt) -> Dfa:
    """The words over an alphabet whose degrees of freedom are of the kinds that a start gives."""
    return _counting(program, alphabet, [start.kind(i) for i in range(len(start.values))])


def _counting(
    program: ir.Program, alphabet: tuple[str, ...], kinds: Sequence[ir.DofKind | None]
) -> Dfa:
    """The words with degrees of freedom of these kinds, in order; None means any kind.

    State k: k degrees of freedom were read, and they fit; the last state is dead.
    """
    modules = [program.modules.get(name) for name in alphabet]
    dofs = [() if module is None else tuple(dof.kind for dof in module.dofs) for module in modules]
    count = len(kinds)
    dead = count + 1

    def target(state: int, read: Sequence[ir.DofKind]) -> int:
        end = state + len(read)
        if state == dead or end > count:
            return dead
        pairs = zip(kinds[state:end], read, strict=True)
        return end if all(wanted in (None, kind) for wanted, kind in pairs) else dead

    table = tuple(target(state, read) for state in range(count + 2) for read in dofs)
    return Dfa(alphabet, table, tuple(state == count for state in range(count + 2)))
