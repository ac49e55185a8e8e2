"""Write convex pieces as OBJ files with exact decimals and one object for each piece."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from srgc.paths import unwritable, write_output

if TYPE_CHECKING:
    from collections.abc import Sequence

    from srgc.imports.meshes.convex_piece import ConvexPiece


def pieces_text(
    pieces: Sequence[ConvexPiece], names: Sequence[str], comments: Sequence[str]
) -> str:
    """An OBJ file, in metres, with an object for each piece.

    Vertices are exact decimals; triangles face outwards.
    """
    lines = [f"# {line}" for line in comments]
    before = 1
    for piece, name in zip(pieces, names, strict=True):
        lines.append(f"o {name}")
        lines += [f"v {x} {y} {z}" for x, y, z in piece.decimals()]
        lines += [f"f {a + before} {b + before} {c + before}" for a, b, c in piece.outward()]
        before += len(piece.corners)
    return "\n".join(lines) + "\n"


def written_pieces(
    pieces: Sequence[ConvexPiece], folder: Path, stem: str, *, comments: Sequence[str] = ()
) -> list[Path]:
    """Write a file for each piece: ``STEM.obj`` if there is one, else ``STEM_1.obj`` and so on.

    Raises:
        UsageFault: a file cannot be written.
    """
    names = [stem] if len(pieces) == 1 else [f"{stem}_{i + 1}" for i in range(len(pieces))]
    paths = [folder / f"{name}.obj" for name in names]
    for piece, name, path in zip(pieces, names, paths, strict=True):
        _replace(path, pieces_text([piece], [name], comments))
    return paths


def written_scene(
    pieces: Sequence[ConvexPiece], path: Path, *, comments: Sequence[str] = ()
) -> None:
    """Write one file with an object ``piece_1``, ``piece_2``, ... for each piece.

    Raises:
        UsageFault: the file cannot be written.
    """
    names = [f"piece_{i + 1}" for i in range(len(pieces))]
    _replace(path, pieces_text(pieces, names, comments))


def _replace(path: Path, text: str) -> None:
    """Write a file under another name first, so that it never exists in part."""
    pending = path.with_name(f".{path.name}.part")
    write_output(pending, text)
    try:
        pending.replace(path)
    except OSError as error:
        pending.unlink(missing_ok=True)
        raise unwritable(path, error) from None
