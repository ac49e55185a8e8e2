"""Meshes of others: read up to a size, never unpacked, and XML without entities."""

from __future__ import annotations

from pathlib import Path
from typing import TypeAlias
from xml.etree.ElementTree import Element

from srgc.faults import UsageFault
from srgc.paths import refuse_impossible

MOST_BYTES = 200_000_000
"""A file of more is refused before it is read."""
MOST_XML_BYTES = 50_000_000
"""The tree of an XML file takes about ten times its size."""
PACKED = {
    b"PK\x03\x04": "a zip archive",
    b"\x1f\x8b": "packed with gzip",
    b"BZh": "packed with bzip2",
    b"\xfd7zXZ": "packed with xz",
    b"\x28\xb5\x2f\xfd": "packed with zstd",
}
"""How packed files begin, whatever their names say: they are never unpacked."""

Xml: TypeAlias = Element


def limited_bytes(path: Path, most: int = MOST_BYTES) -> bytes:
    """The content of a file.

    Raises:
        UsageFault: it is no file, cannot be read, is empty, packed, or larger than ``most`` bytes.
    """
    refuse_impossible(path)
    try:
        if not path.is_file():
            raise UsageFault(f"{path} is not a file")
        # A file may grow between a question about its size and the reading.
        with path.open("rb") as file:
            content = file.read(most + 1)
    except OSError as error:
        raise UsageFault(f"{path}: {error.strerror}") from None
    refuse_content(content, path, most)
    return content


def refuse_content(content: bytes, path: Path, most: int = MOST_BYTES) -> None:
    """Refuse the content of a file, which is called ``path`` in messages.

    Raises:
        UsageFault: it is empty, packed, or larger than ``most`` bytes.
    """
    if len(content) > most:
        raise UsageFault(
            f"{path} is larger than {most // 1_000_000} MB, and no more is read; simplify it first"
        )
    if not content.strip(b"\0 \t\r\n"):
        raise UsageFault(f"{path} is empty")
    for start, what in PACKED.items():
        if content.startswith(start):
            raise UsageFault(f"{path} is {what}, which is not unpacked here; unpack it first")


def xml_of(content: bytes, path: Path) -> Xml:
    """The root of the XML in ``content``, which was read from ``path``.

    Raises:
        UsageFault: it is no XML, is nested too deeply, or declares a document type.
    """
    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import ParseError, fromstring

    try:
        root: Xml = fromstring(content, forbid_dtd=True)
    except DefusedXmlException:
        raise UsageFault(
            f"{path}: it declares a document type or entities, which are never expanded; "
            "remove the DOCTYPE"
        ) from None
    except (ParseError, ValueError, LookupError) as error:
        raise UsageFault(f"{path} is no XML: {error}") from None
    except RecursionError:
        raise UsageFault(f"{path}: its elements are nested too deeply") from None
    return root
