"""XML from strangers: parsed by lxml without entities, documents of others, or endless depth."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from srgc.faults import UsageFault

if TYPE_CHECKING:
    from lxml.etree import _Element

Element: TypeAlias = "_Element"


def xml_root(data: bytes, path: Path) -> Element:
    """The root of an XML document; comments and processing instructions are left out.

    Raises:
        UsageFault: it is not well-formed, or has a document type, whose entities could stand for
            other files or for endless text.
    """
    from lxml import etree

    parser = etree.XMLParser(
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        huge_tree=False,
        remove_comments=True,
        remove_pis=True,
    )
    try:
        root = etree.fromstring(data, parser)
    except etree.XMLSyntaxError as error:
        line, column = error.position
        said = (error.msg or "not well-formed").partition(", line ")[0]
        raise UsageFault(f"{path}:{line}:{column}: this is no XML: {said}") from None
    except ValueError as error:
        raise UsageFault(f"{path}: this is no XML: {error}") from None
    if root is None:
        raise UsageFault(f"{path}: this is no XML: it is empty")
    if root.getroottree().docinfo.doctype:
        raise UsageFault(
            f"{path}:1: it declares a document type, which robots need not: remove <!DOCTYPE ...>"
        )
    return root


def fault_at(path: Path, element: Element, message: str, hint: str = "") -> UsageFault:
    """A fault of an element: file and line, what is wrong, and what to do."""
    where = f"{path}:{element.sourceline or 1}"
    return UsageFault(f"{where}: {message}" + (f"; {hint}" if hint else ""))
