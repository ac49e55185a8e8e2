"""Signature help inside the brackets of an emission or a function."""

from __future__ import annotations

from lsprotocol import types as lsp

from srgc.language_server.completions.cursor import cursor_at, open_call
from srgc.language_server.completions.emission_forms import EMISSIONS, FUNCTIONS


def signature(text: str, offset: int) -> lsp.SignatureHelp | None:
    """The call that is being written; None outside of calls."""
    cursor = cursor_at(text, offset)
    call = open_call(cursor.statement)
    form = None if call is None else EMISSIONS.get(call.name) or FUNCTIONS.get(call.name)
    if call is None or form is None or cursor.silent:
        return None
    names = [name for name, _ in form.parameters]
    active = min(call.argument, len(names) - 1)
    if form.named:
        current = call.current
        left = [name for name in names if name not in call.named]
        active = names.index(current if current in names else (left or names)[0])
    parameters = [
        lsp.ParameterInformation(name, lsp.MarkupContent(lsp.MarkupKind.Markdown, means))
        for name, means in form.parameters
    ]
    label = form.label(call.name)
    return lsp.SignatureHelp([lsp.SignatureInformation(label, form.means, parameters)], 0, active)
