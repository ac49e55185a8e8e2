"""The claim of a certificate about one structure that is refuted on its own."""

from __future__ import annotations

from dataclasses import dataclass

from solvers.verifier.claims.json_fields import number, objects, text, texts


@dataclass(frozen=True, slots=True)
class StructureClaim:
    """One structure, refuted by a script (``evidence``), by a covering (``boxes``), or by both.

    Both are paths of files. A structure that is the same robot as an earlier one shares its files.
    """

    word: tuple[str, ...]
    derivation: tuple[str, ...]
    evidence: str | None
    same_robot_as: int | None
    boxes: str | None = None


def structure_claims(items: object) -> tuple[StructureClaim, ...]:
    """The structures of a list of JSON objects.

    Raises:
        TypeError, KeyError: the list is malformed.
    """
    return tuple(
        StructureClaim(
            texts(s["word"]),
            texts(s["derivation"]),
            None if s["evidence"] is None else text(s["evidence"]),
            None if s["same_robot_as"] is None else number(s["same_robot_as"]),
            None if s["boxes"] is None else text(s["boxes"]),
        )
        for s in objects(items, StructureClaim)
    )
