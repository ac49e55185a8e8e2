"""Certificates: the claim of a verdict, as plain data with a digest of its canonical content.

Numbers that a proof depends on are decimal strings, read as the exact rationals they denote. The
digest guards against accidents and careless edits, not against malice: an altered certificate with
a new digest is judged like any other claim.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from fractions import Fraction
from pathlib import Path, PurePosixPath
from typing import Any, Literal, TypeAlias

from compiler.expressions.exact_numbers import exact_number
from compiler.robots.parameter_values import ParameterValue, stated_value
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from grammar_lang.files.file_tree import IMAGE_LIMIT, LIMIT, TooLarge, read_file
from solvers.verdict import Claimed
from solvers.verifier.claims.bound_claims import BoundClaim
from solvers.verifier.claims.further_claims import (
    ControllerClaim,
    FurtherClaim,
    LoopClaim,
    claim_content,
    further_claims,
)
from solvers.verifier.claims.json_fields import expect_keys, number, objects, rows, text, texts
from solvers.verifier.claims.lemma_claims import (
    DistanceClaim,
    LemmaClaim,
    VariantClaim,
    WeightsClaim,
)
from solvers.verifier.claims.objective_claims import ObjectivesClaim
from solvers.verifier.claims.structure_claims import StructureClaim, structure_claims

FORMAT, WITH_CLAIMS = 3, 4
"""Format 2 added cuts of cells and separated regions; 3, coverings by boxes; 4, a list of further
claims, such as a controller. Verdicts without further claims are written in format 3."""


class CertificateError(ValueError):
    """The file is not a certificate, or its digest does not match its content."""


@dataclass(frozen=True, slots=True)
class ParameterClaim:
    """A parameter of the module at word index ``symbol``, in SI units."""

    symbol: int
    name: str
    value: str


CutClaim: TypeAlias = tuple[int, tuple[str, ...], str]
"""The number of a cell, and the normal and offset of the half-space that cuts it."""


@dataclass(frozen=True, slots=True)
class FoundClaim:
    """This robot, with this start and these inputs, does the task.

    ``start`` holds the coordinates, then the rates; ``inputs`` one row per step; ``path`` the cell
    of every effector at every sample; ``effector`` (from 0) is the one that starts and reaches;
    ``cuts``, made in this order, turn the cells of the workspace into those of ``path``. With a
    controller among the ``claims``, ``inputs`` are those of the motion without deviations.
    """

    task: str
    spec: str
    spec_sha256: str
    word: tuple[str, ...]
    derivation: tuple[str, ...]
    parameters: tuple[ParameterClaim, ...]
    effector: int
    steps: int
    step: str
    start: tuple[str, ...]
    inputs: tuple[tuple[str, ...], ...]
    path: tuple[tuple[str, ...], ...]
    effort_peak: str
    robustness: str
    cuts: tuple[CutClaim, ...] = ()
    claims: tuple[FurtherClaim, ...] = ()

    @property
    def controller(self) -> ControllerClaim | None:
        """The controller; None for stated inputs without feedback."""
        found = [claim for claim in self.claims if isinstance(claim, ControllerClaim)]
        return found[0] if found else None

    @property
    def loop(self) -> LoopClaim | None:
        """The loop of a motion that goes on for ever; None for a motion that ends."""
        found = [claim for claim in self.claims if isinstance(claim, LoopClaim)]
        return found[0] if found else None

    @property
    def bound(self) -> BoundClaim | None:
        """The claimed bound that no robot of the family exceeds; None if there is no such claim."""
        found = [claim for claim in self.claims if isinstance(claim, BoundClaim)]
        return found[0] if found else None

    @property
    def objectives(self) -> ObjectivesClaim | None:
        """The claimed values of the task's objectives; None if there is no such claim."""
        found = [claim for claim in self.claims if isinstance(claim, ObjectivesClaim)]
        return found[0] if found else None


@dataclass(frozen=True, slots=True)
class SeparationClaim:
    """Two regions that one effector has to visit are separated by regions that it never enters.

    ``effector`` is its number from 1, None for the recorded effector if the task names none;
    ``cells`` are the cells, none of them ``avoided``, that chains of touching cells from ``source``
    reach.
    """

    effector: int | None
    source: str
    target: str
    avoided: tuple[str, ...]
    cells: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ImpossibleClaim:
    """No structure with at most ``modules`` modules (None: of any size) can do the task.

    With a ``separation``, no robot at all can do it, and no structures are listed. Structures whose
    words satisfy a lemma among the ``claims`` are not listed.
    """

    task: str
    spec: str
    spec_sha256: str
    modules: int | None
    structures: tuple[StructureClaim, ...]
    separation: SeparationClaim | None = None
    claims: tuple[FurtherClaim, ...] = ()

    @property
    def lemmas(self) -> tuple[LemmaClaim, ...]:
        """The lemmas, in order."""
        return tuple(
            claim
            for claim in self.claims
            if isinstance(claim, DistanceClaim | VariantClaim | WeightsClaim)
        )


Claim = FoundClaim | ImpossibleClaim


def control_of(claim: FoundClaim) -> Literal["open loop", "feedback"]:
    """Whether the inputs are fixed ("open loop") or corrected by a controller ("feedback")."""
    return "open loop" if claim.controller is None else "feedback"


def verdict_of(claim: Claim) -> Claimed:
    """The verdict that a claim states."""
    return "found" if isinstance(claim, FoundClaim) else "impossible"


def parameter_claims(values: Iterable[ParameterValue]) -> tuple[ParameterClaim, ...]:
    """The claims that a certificate makes for the parameters of a robot."""
    return tuple(
        ParameterClaim(value.parameter.symbol, value.parameter.name, value.text) for value in values
    )


def claimed_values(claim: FoundClaim, model: RobotModel) -> tuple[ParameterValue, ...]:
    """The values that a claim states for the parameters of a robot.

    Raises:
        CertificateError: the parameters are not the robot's, or a value is outside its domain.
    """
    expected = [(parameter.symbol, parameter.name) for parameter in model.parameters]
    if [(claimed.symbol, claimed.name) for claimed in claim.parameters] != expected:
        raise CertificateError("the parameters are not those of the robot")
    values = []
    for claimed, parameter in zip(claim.parameters, model.parameters, strict=True):
        value = stated_value(parameter, exact(claimed.value))
        if value is None:
            raise CertificateError(
                f"`{parameter.module}.{parameter.name}` = {claimed.value} "
                f"at symbol {parameter.symbol} is outside its range"
            )
        values.append(value)
    return tuple(values)


def exact(text: str) -> Fraction:
    """The rational that a decimal or a quotient of whole numbers denotes.

    Raises:
        CertificateError: the text is neither of them, or the quotient's denominator is zero.
    """
    try:
        return exact_number(text)
    except ValueError as error:
        raise CertificateError(f"the certificate is malformed: {error}") from None


def cut_claim(cell: int, half_space: ir.HalfSpace) -> CutClaim:
    """A cut as a certificate states it."""
    return cell, tuple(str(a) for a in half_space.normal), str(half_space.offset)


def exact_cuts(cuts: Sequence[CutClaim]) -> tuple[tuple[int, ir.HalfSpace], ...]:
    """The cuts of a claim: numbers of cells, and exact half-spaces.

    Raises:
        CertificateError: a number is malformed.
    """
    return tuple(
        (cell, ir.HalfSpace(tuple(exact(a) for a in normal), exact(offset)))
        for cell, normal, offset in cuts
    )


def spec_digest(files: Mapping[str, bytes]) -> str:
    """SHA-256 over the sorted relative paths and the bytes of a spec and all files it includes."""
    digest = hashlib.sha256()
    for name in sorted(files):
        path, content = name.encode("utf-8", "surrogateescape"), files[name]
        digest.update(len(path).to_bytes(8, "big") + path)
        digest.update(len(content).to_bytes(8, "big") + content)
    return digest.hexdigest()


def spec_files(folder: Path) -> dict[str, bytes]:
    """The files below a folder, by their relative paths.

    Raises:
        CertificateError: the folder holds a link, which may lead anywhere, something that is
            neither a file nor a folder, or more bytes than the texts and images of a spec may have.
        OSError: a file cannot be read.
    """
    files: dict[str, bytes] = {}
    left = LIMIT + IMAGE_LIMIT
    for path in [folder, *sorted(folder.rglob("*"))]:
        if path.is_symlink() or (path.exists() and not path.is_dir() and not path.is_file()):
            raise CertificateError(f"the spec has been altered: {path} is not a plain file")
        if path.is_file():
            try:
                data = read_file(path, left)
            except TooLarge as large:
                raise CertificateError(
                    f"the spec has been altered: with the {large.size:,} bytes of {path} its files "
                    f"have more than {LIMIT + IMAGE_LIMIT:,}"
                ) from None
            left -= len(data)
            files[str(PurePosixPath(path.relative_to(folder)))] = data
    return files


def to_text(claim: Claim) -> str:
    """The certificate file of a claim."""
    fields, further = asdict(claim), [claim_content(each) for each in claim.claims]
    del fields["claims"]
    form = WITH_CLAIMS if further else FORMAT
    content = {"format": form, "kind": verdict_of(claim), **fields}
    if further:
        content["claims"] = further
    content["digest"] = digest_of(content)
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def digest_of(content: Mapping[str, Any]) -> str:
    """SHA-256 of the canonical form: sorted keys, no whitespace, the digest itself left out."""
    bare = {key: value for key, value in content.items() if key != "digest"}
    canonical = json.dumps(bare, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(canonical.encode()).hexdigest()


def from_text(text: str) -> Claim:
    """Read a certificate.

    Raises:
        CertificateError: the text is not a certificate of a known format, or was altered since it
            was written.
    """
    content = checked_object(text)
    form = content.get("format")
    if form not in (FORMAT, WITH_CLAIMS) or not isinstance(form, int) or isinstance(form, bool):
        raise CertificateError(f"the certificate is not of format {FORMAT} or {WITH_CLAIMS}")
    kind = content.get("kind")
    fields = {k: v for k, v in content.items() if k not in ("format", "kind", "digest")}
    if ("claims" in fields) is not (content["format"] == WITH_CLAIMS):
        raise CertificateError("the certificate is malformed: `claims` are those of format 4")
    try:
        if kind == "found":
            return _found(fields)
        if kind == "impossible":
            return _impossible(fields)
    except (TypeError, KeyError, ValueError) as error:
        raise CertificateError(f"the certificate is malformed: {error.args[0]}") from None
    raise CertificateError(f"the certificate is of an unknown kind: {kind!r}")


def checked_object(text: str) -> dict[str, Any]:
    """The JSON object of a certificate whose digest matches its content.

    Raises:
        CertificateError: the text is not such an object.
    """
    try:
        content = json.loads(text, object_pairs_hook=_once, parse_constant=_no_constant)
        if not isinstance(content, dict) or "digest" not in content:
            raise CertificateError("the certificate is not a JSON object with a digest")
        digest = digest_of(content)
    except CertificateError:
        raise
    except (ValueError, RecursionError) as error:
        # Not JSON, or an integer or a surrogate that Python reads but cannot write.
        reason = "nested too deeply" if isinstance(error, RecursionError) else str(error)
        raise CertificateError(f"the certificate is not JSON: {reason}") from None
    if content["digest"] != digest:
        raise CertificateError(
            "the certificate has been altered: its digest does not match its content"
        )
    return content


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object without repeated keys: readers differ in which of the values they use."""
    content = dict(pairs)
    if len(content) != len(pairs):
        raise ValueError("a key is repeated")
    return content


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} is no JSON value")


def _found(fields: dict[str, Any]) -> FoundClaim:
    fields = {"claims": [], **fields}
    expect_keys(fields, FoundClaim)
    fields["parameters"] = tuple(
        ParameterClaim(number(p["symbol"]), text(p["name"]), text(p["value"]))
        for p in objects(fields["parameters"], ParameterClaim)
    )
    for name in ("word", "derivation", "start"):
        fields[name] = texts(fields[name])
    for name in ("inputs", "path"):
        fields[name] = rows(fields[name])
    for name in ("task", "spec", "spec_sha256", "step", "effort_peak", "robustness"):
        text(fields[name])
    for name in ("effector", "steps"):
        number(fields[name])
    fields["cuts"] = _cuts(fields["cuts"])
    fields["claims"] = further_claims(fields["claims"])
    return FoundClaim(**fields)


def _cuts(items: object) -> tuple[CutClaim, ...]:
    if not isinstance(items, list) or not all(isinstance(i, list) and len(i) == 3 for i in items):
        raise TypeError("a list of cuts is expected, each a cell, a normal and an offset")
    return tuple((number(cell), texts(normal), text(offset)) for cell, normal, offset in items)


def _impossible(fields: dict[str, Any]) -> ImpossibleClaim:
    fields = {"claims": [], **fields}
    expect_keys(fields, ImpossibleClaim)
    fields["structures"] = structure_claims(fields["structures"])
    for name in ("task", "spec", "spec_sha256"):
        text(fields[name])
    if fields["modules"] is not None:
        number(fields["modules"])
    fields["separation"] = separation_claim(fields["separation"])
    fields["claims"] = further_claims(fields["claims"])
    if any(isinstance(claim, BoundClaim | ObjectivesClaim) for claim in fields["claims"]):
        raise ValueError("bounds or objectives are claimed of a task that no robot does")
    return ImpossibleClaim(**fields)


def separation_claim(content: object) -> SeparationClaim | None:
    """The separation of a JSON object, None for null; raises what ``objects`` raises."""
    if content is None:
        return None
    (fields,) = objects([content], SeparationClaim)
    return SeparationClaim(
        None if fields["effector"] is None else number(fields["effector"]),
        text(fields["source"]),
        text(fields["target"]),
        texts(fields["avoided"]),
        texts(fields["cells"]),
    )
