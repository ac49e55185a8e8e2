"""Files of others: read up to a size, XML without entities, and no path that leaves a folder."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias
from xml.etree.ElementTree import Element

from srgc.faults import UsageFault
from srgc.paths import refuse_impossible

if TYPE_CHECKING:
    from collections.abc import Mapping

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
    if len(content) > most:
        raise UsageFault(
            f"{path} is larger than {most // 1_000_000} MB, the most that is read; simplify it first"
        )
    if not content.strip(b"\0 \t\r\n"):
        raise UsageFault(f"{path} is empty")
    for start, what in PACKED.items():
        if content.startswith(start):
            raise UsageFault(f"{path} is {what}, which is not unpacked here; unpack it first")
    return content


def limited_xml(path: Path) -> Xml:
    """The root of an XML file; entities and document types are refused before they mean anything.

    Raises:
        UsageFault: as :func:`limited_bytes`, or it is no XML, or declares a document type.
    """
    return xml_of(limited_bytes(path, MOST_XML_BYTES), path)


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


class FileTree:
    """Where the files named by a file may be: below its folder, or below packages that are given."""

    def __init__(self, root: Path, packages: Mapping[str, Path] | None = None) -> None:
        self.root = root.resolve()
        self.packages = {name: path.resolve() for name, path in (packages or {}).items()}

    def found(self, reference: str) -> Path:
        """The file of a path or of a ``package://``, ``model://`` or ``file://`` address.

        Raises:
            UsageFault: it is nowhere, or it would be outside the folders that may be read.
        """
        scheme, colon, rest = reference.partition("://")
        if not colon:
            return self._below(self.root, reference, reference)
        if scheme not in {"package", "model", "file"}:
            raise UsageFault(f"{reference}: nothing is fetched from a network; name a file")
        if scheme == "file":
            return self._below(self.root, rest, reference)
        name, _, inside = rest.partition("/")
        if name in self.packages:
            return self._below(self.packages[name], inside, reference)
        for folder in (self.root / name, self.root):
            if (folder / inside).exists() and (folder == self.root / name or self._named(name)):
                return self._below(folder, inside, reference)
        raise UsageFault(
            f"{reference} is not below the folder of the file; `--package {name}=DIR` says where "
            "it is"
        )

    def _named(self, name: str) -> bool:
        """Whether the folder of the file, or one above the file's, is called so."""
        return self.root.name == name

    def _below(self, folder: Path, inside: str, reference: str) -> Path:
        if "\0" in inside:
            raise UsageFault(f"{reference!r}: no path has a NUL character")
        path = (folder / inside).resolve()
        if not any(path.is_relative_to(each) for each in (self.root, *self.packages.values())):
            raise UsageFault(
                f"{reference} leads out of the folder of the file, where nothing is read; copy it, "
                "or name its folder with `--package NAME=DIR`"
            )
        if not path.is_file():
            raise UsageFault(f"{reference}: there is no such file")
        return path
