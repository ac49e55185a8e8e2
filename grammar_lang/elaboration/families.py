"""Robot families, as far as tasks need to know them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.elaboration.modules import ModuleInfo
from grammar_lang.elaboration.productions import GrammarInfo
from grammar_lang.elaboration.semantics import SemanticsInfo
from grammar_lang.elaboration.sorts import DimensionUse
from grammar_lang.syntax import tasks as t


@dataclass(frozen=True, slots=True)
class Family:
    """The properties of a robot family that tasks need.

    ``kinds`` are the kinds of its joints, and ``driven`` those of joints with an unbounded free
    input, in fixed order.  ``modules`` are those in its productions, in declaration order.
    """

    kinds: tuple[ir.DofKind, ...]
    driven: tuple[ir.DofKind, ...]
    has_semantics: bool
    uses: tuple[DimensionUse, ...]
    modules: tuple[str, ...]


def family_of(
    grammar: GrammarInfo, semantics: SemanticsInfo | None, modules: Mapping[str, ModuleInfo]
) -> Family:
    """The family of a grammar.

    Args:
        grammar: the grammar.
        semantics: its semantics, if it has one.
        modules: the modules of the file.
    """
    symbols = {x.name for p in grammar.grammar.productions for x in p.right}
    names = tuple(name for name in modules if name in symbols)
    used = [modules[name].module for name in names]
    joints = {dof.kind for module in used for dof in module.dofs}
    driven = {dof.kind for module in used for dof in module.free_dofs if dof.effort is None}
    kinds: tuple[ir.DofKind, ...] = ("revolute", "prismatic")
    return Family(
        kinds=tuple(kind for kind in kinds if kind in joints),
        driven=tuple(kind for kind in kinds if kind in driven),
        has_semantics=semantics is not None,
        uses=() if semantics is None else semantics.uses,
        modules=names,
    )


def check_family(
    family: Family, robot: t.Robot, workspace: ir.Workspace | None, sink: Sink
) -> None:
    """Report a family without a semantics, or one that does not fit the workspace's dimension."""
    if not family.has_semantics:
        message = f"grammar `{robot.name.text}` has no semantics, so it describes no robot"
        hint = f"add `semantics {robot.name.text} {{ … }}`"
        sink.error(Code.MISSING_BLOCK, message, robot.name.span, hint)
    if workspace is None:
        return
    where = "`plane xy`" if workspace.dimension == 2 else "`space xyz`"
    for use in family.uses:
        known = any(d.code is Code.OUT_OF_PLANE and d.span == use.span for d in sink.found)
        if use.only != workspace.dimension and not known:
            hint = f"workspace `{workspace.name}` is {where}"
            notes = [(robot.span, "the task that joins them")]
            sink.error(Code.OUT_OF_PLANE, use.message, use.span, hint, notes)
