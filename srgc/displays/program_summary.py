"""A specification in a few lines, and its text in colours."""

from __future__ import annotations

from collections.abc import Iterator

from grammar_lang import ir
from srgc.render.html_block import block, code, details, head, table
from srgc.render.html_text import text


def program_text(program: ir.Program) -> str:
    """What a specification declares, as plain text."""
    rows = [(kind, names, said) for kind, names, said in _facts(program)]
    return "\n".join(
        [
            program.sources[0].path,
            *(f"{kind:<10} {name:<14} {said}".rstrip() for kind, name, said in rows),
        ]
    )


def program_html(program: ir.Program) -> str:
    """A display of what a specification declares, and of its text."""
    rows = [(text(kind), code(name), text(said)) for kind, name, said in _facts(program)]
    files = "".join(
        details(source.path, _coloured_source(source.text))
        for source in program.sources
        if source.text
    )
    return block(head(program.sources[0].path), table(("", "", ""), rows), files)


def _facts(program: ir.Program) -> Iterator[tuple[str, str, str]]:
    for module in program.modules.values():
        yield "module", module.name, _of_module(module)
    for grammar in program.grammars.values():
        count = len(grammar.productions)
        yield "grammar", grammar.name, f"{count} production{'' if count == 1 else 's'}"
    for place in program.workspaces.values():
        kinds = [f"{region.kind} {region.name}" for region in place.regions]
        plane = "plane" if place.dimension == 2 else "space"
        yield "workspace", place.name, f"{plane}: {', '.join(kinds) or 'no regions'}"
    for task in program.tasks.values():
        seconds = float(task.steps * task.step)
        yield "task", task.name, f"{task.grammar} in {task.workspace}, {seconds:g} s"


def _of_module(module: ir.Module) -> str:
    items: list[str] = [module.role]
    items += [f"{dof.kind} {dof.name}" for dof in module.dofs]
    items += [f"parameter {each.name}" for each in module.parameters]
    items += [f"state {each.name}" for each in module.states]
    items += [f"input {each.name}" for each in module.inputs]
    return ", ".join(items)


def _coloured_source(content: str) -> str:
    from pygments import highlight
    from pygments.formatters import HtmlFormatter

    from srgc.pygments_lexer import SrgLexer

    style = "background:#f8f8f8;color:#222;padding:.6em"
    formatter = HtmlFormatter(noclasses=True, nobackground=True, cssstyles=style)
    return str(highlight(content, SrgLexer(), formatter))
