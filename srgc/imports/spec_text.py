"""The whole text of an import in canonical form: its source, modules and grammars."""

from __future__ import annotations

from collections.abc import Iterable

from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.formatting.formatter import canonical
from srgc.imports.comment_lines import comment_lines
from srgc.imports.module_set import ModuleSet
from srgc.imports.module_text import family_text, module_text
from srgc.imports.quantities import Quantities


def spec_text(modules: ModuleSet, *, exact: bool = False) -> str:
    """The text of a set of modules.

    Args:
        modules: what was read; remarks about rounded angles and lengths are added to it.
        exact: whether angles and lengths are kept as they are.
    """
    blocks = modules_text(modules, exact=exact)
    head = [*modules.comments]
    told = [*(warning.in_comment() for warning in modules.warnings), *modules.remarks]
    if told:
        head += ["Not carried over, or changed:", *(f"- {line}" for line in told)]
    return canonical_text([comment_lines(head), *blocks])


def modules_text(modules: ModuleSet, *, exact: bool = False) -> list[str]:
    """The blocks of modules and grammars; see :func:`spec_text`."""
    quantities = Quantities(exact)
    blocks = [module_text(module, quantities) for module in modules.modules]
    blocks += [family_text(family) for family in modules.families]
    if quantities.rounded:
        many = "1 angle was" if quantities.rounded == 1 else f"{quantities.rounded} angles were"
        modules.remarks.append(
            f"{many} rounded to whole multiples of 15 deg, by at most {quantities.most:.1g} rad; "
            "--exact keeps them"
        )
    if quantities.left_out:
        lengths = "1 length" if quantities.left_out == 1 else f"{quantities.left_out} lengths"
        modules.remarks.append(f"{lengths} below 1 um taken for 0; --exact keeps them")
    return blocks


def canonical_text(blocks: Iterable[str]) -> str:
    """Blocks of text with empty lines between them, in canonical form.

    Raises:
        AssertionError: the text has a syntax error, which is a fault of the importer.
    """
    sink = Sink()
    text = canonical("\n\n".join(filter(None, blocks)) + "\n", sink)
    if text is None:
        raise AssertionError(f"import wrote a text with errors: {sink.sorted()[0].message}")
    return text
