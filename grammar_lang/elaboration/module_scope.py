"""The meaning of names inside a module, outside its dynamics: parameters, constants and ``pi``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.elaboration.sorts import UNKNOWN, DimensionUse, Typed
from grammar_lang.elaboration.typecheck import plain_name


def foreign_member(member: s.Member, sink: Sink, hint: str | None = None) -> Typed:
    """Report ``owner.name`` inside a module."""
    message = f"`{member.owner.text}.{member.name.text}` has no meaning inside a module"
    own = "use the module's own names alone"
    sink.error(Code.NOT_CONSTANT, message, member.span, hint or own)
    return UNKNOWN


@dataclass(slots=True)
class ModuleScope:
    """The parameters and constants declared so far; ``kinds`` is the kind of every name."""

    kinds: Mapping[str, str]
    members: dict[str, Typed] = field(default_factory=dict[str, Typed])
    uses: list[DimensionUse] = field(default_factory=list[DimensionUse])

    def name(self, ident: s.Ident, sink: Sink) -> Typed:
        """A parameter, a constant, ``pi``, or an error."""
        if ident.text in self.members:
            return self.members[ident.text]
        kind = self.kinds.get(ident.text)
        if kind is None:
            return plain_name(ident, tuple(self.members), sink)
        if kind in {"parameter", "constant"}:
            message = f"`{ident.text}` is not declared before its use"
            hint = "parameters and constants are declared before they are used"
        else:
            message = f"the {kind} `{ident.text}` is not a constant"
            hint = "a constant is made of numbers, units, other constants and `pi`"
        sink.error(Code.NOT_CONSTANT, message, ident.span, hint)
        return UNKNOWN

    def member(self, member: s.Member, sink: Sink) -> Typed:
        """Report an error: a module cannot read ``owner.name``."""
        return foreign_member(member, sink)

    def dof(self, name: s.Member | s.Name) -> ir.Dof | None:
        """None: a degree of freedom cannot be used here."""
        del name
        return None

    def use_dof(self, name: s.Member | s.Name) -> ir.Expr:
        """Raise LookupError: never called, because no degree of freedom can be used here."""
        raise LookupError(name)

    def mentions(self, expressions: Iterable[s.Expr]) -> tuple[int, ...]:
        """Empty: there are no modules of a production here."""
        del expressions
        return ()
