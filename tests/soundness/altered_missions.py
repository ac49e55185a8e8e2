"""Results of missions altered in every way that is thought of; digests are made anew.

What of them is still true, `judged_missions.py` says.
"""

from __future__ import annotations

import copy
import itertools
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any

from tests.oracles.result_files import digest, read, write
from tests.soundness.judged_missions import Content

CLAIM = "mission.json"
HUGE = "9" * 299


@dataclass(frozen=True)
class Altered:
    """A change of a folder; ``accepted`` where no judge is asked, and None where both are right."""

    name: str
    change: Callable[[Path], None]
    accepted: bool | str | None = "judged"


def changed(folder: Path, change: Callable[[Content], None], name: str = CLAIM) -> None:
    """Alter a claim, and give it the digest that fits."""
    content = read(folder, name)
    change(content)
    content["digest"] = digest(content)
    write(folder, content, name)


def at(*path: str | int, to: Any) -> Callable[[Path], None]:
    """What stands at a place of the claim is something else."""

    def change(content: Content) -> None:
        place: Any = content
        for key in path[:-1]:
            place = place[key]
        place[path[-1]] = copy.deepcopy(to)

    return partial(changed, change=change)


# --- what is claimed ------------------------------------------------------------------------------


def of_numbers(claim: Content) -> Iterator[Altered]:
    """Costs, least costs, objectives; they are read as exact numbers."""
    places: list[tuple[str | int, ...]] = [("cost",), ("least",)]
    if claim["objectives"]:
        count = len(claim["objectives"])
        places = [("objectives", k, name) for k in range(count) for name in ("value", "least")]
    for place in places:
        value: Any = claim
        for key in place:
            value = value[key]
        if value is None:
            yield Altered(f"{place} is 1", at(*place, to="1"), accepted=False)
            continue
        number = Fraction(value)
        for other in (
            number + 1,
            number - 1,
            number + Fraction(1, 10**12),
            number / 2,
            number * 3,
            0,
        ):
            if other != number:
                yield Altered(f"{place} is {other}", at(*place, to=str(Fraction(other))))
        yield Altered(f"{place} is huge", at(*place, to=HUGE), accepted=False)
        for text in ("nan", "inf", "1e9", "", "two", "1/0", 1, None, True, [], "9" * 400):
            yield Altered(f"{place} is {str(text)[:9]}", at(*place, to=text), accepted=False)


def of_kind(claim: Content) -> Iterator[Altered]:
    other = "impossible" if claim["kind"] == "found" else "found"
    yield Altered("the other kind", at("kind", to=other), accepted=False)
    yield Altered("no kind", at("kind", to="maybe"), accepted=False)
    for key in claim:
        if key not in ("digest", "posed", "modules", "existing"):
            yield Altered(f"no {key}", partial(changed, change=lambda c, k=key: c.pop(k)), False)
    yield Altered("one key more", at("more", to=1), accepted=False)
    yield Altered("another mission", at("mission", to="N"), accepted=False)
    yield Altered("the name of a task", at("mission", to="A"), accepted=False)
    yield Altered("another spec", at("spec", to="../x.srg"), accepted=False)
    yield Altered("another digest", at("spec_sha256", to="0" * 64), accepted=False)
    yield Altered("format 2", at("format", to=2), accepted=False)
    posed = {"add": "1", "remove": "1", "change": "0", "free": [], "most": None}
    yield Altered("posed", at("posed", to=posed), accepted=False)
    yield Altered(
        "posed for a task", lambda f: (at("posed", to=posed)(f), at("mission", to="A")(f))[0], False
    )
    for price in ("-1", "nan", HUGE):
        yield Altered(
            f"posed at {price[:3]}", at("posed", to={**posed, "add": price}), accepted=False
        )


def of_bounds(claim: Content) -> Iterator[Altered]:
    modules = claim["modules"]
    for other in (1, 4, -1, 10**6, 10**30, "5", True, 2.5):
        if other != modules:
            refused = isinstance(other, (str, bool, float)) or other < 1
            yield Altered(f"{other} modules", at("modules", to=other), False if refused else None)
    if claim["existing"] is None:
        word = claim["tasks"][0]["structures"][0]["word"] if claim["tasks"][0]["structures"] else []
        robot = {"word": word, "parameters": [], "source": "from"}
        yield Altered("a robot there is", at("existing", to=robot), accepted=False)
        return
    yield Altered("no robot there is", at("existing", to=None), accepted=False)
    word = claim["existing"]["word"]
    yield Altered("another robot there is", at("existing", "word", to=[*word, "Hand"]), False)
    yield Altered("a shorter one", at("existing", "word", to=word[:-1]), accepted=False)


# --- evidence -------------------------------------------------------------------------------------


def of_structures(claim: Content) -> Iterator[Altered]:
    tasks = claim["tasks"]
    yield Altered("tasks in another order", at("tasks", to=tasks[::-1]), None)
    yield Altered("a task twice", at("tasks", to=[*tasks, tasks[0]]), None)
    yield Altered("no tasks", at("tasks", to=[]), None)
    for k, task in enumerate(tasks):
        own = task["structures"]
        for i, each in enumerate(own):
            rest = [*own[:i], *own[i + 1 :]]
            if not any(s["same_robot_as"] is not None for s in own):
                yield Altered(f"{k}: structure {i} left out", at("tasks", k, "structures", to=rest))
            yield Altered(f"{k}: {i} twice", at("tasks", k, "structures", to=[*own, each]), None)
            if each["boxes"] is None:
                continue
            bare = {**each, "boxes": None, "evidence": None}
            yield Altered(f"{k}: {i} unproved", at("tasks", k, "structures", i, to=bare), None)
            for name in ("../mission.json", "/etc/passwd", "proofs/none.boxes", CLAIM, "", "a\0b"):
                yield Altered(
                    f"{k}: {i} by {name!r}", at("tasks", k, "structures", i, "boxes", to=name), None
                )
        yield Altered(f"{k}: no structures", at("tasks", k, "structures", to=[]))
        # What is refuted in one task is said to be refuted in the others.
        for j, other in enumerate(tasks):
            if j != k:
                both = [*own, *(s for s in other["structures"] if s not in own)]
                yield Altered(f"{k}: all of {j}, too", at("tasks", k, "structures", to=both))
                yield Altered(
                    f"{k}: those of {j}", at("tasks", k, "structures", to=other["structures"])
                )


def places(
    tree: Any, path: tuple[str | int, ...] = ()
) -> Iterator[tuple[tuple[str | int, ...], Any]]:
    """All nodes of a tree, with where they stand."""
    yield path, tree
    if tree is not None and "parts" in tree:
        for k, part in enumerate(tree["parts"]):
            yield from places(part, (*path, "parts", k))


def of_trees(claim: Content) -> Iterator[Altered]:
    boxes = claim["boxes"]
    yield Altered("no boxes", at("boxes", to=[]))
    for k, each in enumerate(boxes):
        yield Altered(f"boxes {k} left out", at("boxes", to=[*boxes[:k], *boxes[k + 1 :]]))
        yield Altered(f"boxes {k} twice", at("boxes", to=[*boxes, each]))
        yield Altered(f"boxes {k} of no task", at("boxes", k, "task", to=99), None)
        if each["task"] is not None:
            yield Altered(f"boxes {k} of another task", at("boxes", k, "task", to=1 - each["task"]))
        yield Altered(f"boxes {k} is null", at("boxes", k, "tree", to=None))
        files = [node["boxes"] for _, node in places(each["tree"]) if node and "boxes" in node]
        for path, node in places(each["tree"]):
            yield from of_node(("boxes", k, "tree", *path), node, each["task"] or 0, files)


def of_node(
    where: tuple[str | int, ...], node: Any, task: int, files: list[str]
) -> Iterator[Altered]:
    if node is None:
        for name in files[:2]:
            leaf = {"task": task, "boxes": name}
            yield Altered(f"{where} refuted by {name}", at(*where, to=leaf))
    elif "parts" in node:
        yield from of_cut(where, node)
    else:
        yield Altered(f"{where} open", at(*where, to=None))
        yield Altered(f"{where} of task 9", at(*where, "task", to=9), None)
        for name in ("../x", "/etc/passwd", *files):
            if name != node["boxes"]:
                yield Altered(f"{where} by {name}", at(*where, "boxes", to=name), None)


def of_cut(where: tuple[str | int, ...], node: Content) -> Iterator[Altered]:
    yield Altered(f"{where} swapped", at(*where, "parts", to=node["parts"][::-1]))
    for value in (0, 1, 2, 3, -1, 10**20, "0.5", "nan", True, None):
        if value != node["at"] or value is True:
            yield Altered(f"{where} at {value}", at(*where, "at", to=value), _cut(value))
    for value in (0, 1, 2, -1, 10**20):
        if value != node["parameter"]:
            yield Altered(f"{where} of {value}", at(*where, "parameter", to=value))
    yield Altered(f"{where} one part", at(*where, "parts", to=node["parts"][:1]), accepted=False)


def _cut(value: object) -> str | None:
    """Cuts that are no whole numbers are of no choices, and are refused where that is needed."""
    return "judged" if isinstance(value, int) and not isinstance(value, bool) else None


def deep(low: Fraction, high: Fraction, depth: int) -> str:
    """A box that is cut again and again near its lower end, as JSON."""
    cuts = [low + (high - low) * (depth - k) / (depth + 1) for k in range(depth)]
    nested = "".join(f'{{"parameter": 0, "at": "{cut}", "parts": [' for cut in cuts)
    return nested + "null" + ", null]}" * depth


# --- files ----------------------------------------------------------------------------------------


def of_files(claim: Content, folder: Path) -> Iterator[Altered]:
    def gone(name: str) -> Callable[[Path], None]:
        return lambda f: (f / name).unlink() if (f / name).is_file() else shutil.rmtree(f / name)

    def link(name: str) -> Callable[[Path], None]:
        def change(copied: Path) -> None:
            gone(name)(copied)
            (copied / name).symlink_to(folder / name)

        return change

    def filled(name: str, data: bytes) -> Callable[[Path], None]:
        return lambda f: overwrite(f / name, data)

    yield Altered("no claim", gone(CLAIM), accepted=False)
    yield Altered("an empty claim", filled(CLAIM, b""), accepted=False)
    yield Altered("no JSON", filled(CLAIM, b"{" * 10_000), accepted=False)
    yield Altered("lists", filled(CLAIM, b"[" * 100_000), accepted=False)
    yield Altered("no text", filled(CLAIM, b"\xff\xfe\x00"), accepted=False)
    yield Altered("no spec", gone("spec"), accepted=False)
    (spec,) = (each.name for each in (folder / "spec").iterdir())
    text = (folder / "spec" / spec).read_bytes()
    yield Altered("a longer spec", filled(f"spec/{spec}", text + b"\n"), accepted=False)
    files = sorted(str(p.relative_to(folder)) for p in (folder / "proofs").rglob("*.boxes"))
    for one, other in itertools.pairwise(files[:6]):
        data = (folder / other).read_bytes()
        yield Altered(f"{one} is {other}", filled(one, data), None)
        yield Altered(f"{one} is empty", filled(one, b""), None)
        yield Altered(f"{one} is gone", gone(one), None)
        yield Altered(f"{one} is a link to elsewhere", link(one), None)
    if claim["kind"] == "impossible":
        return
    names = [task["task"] for task in claim["tasks"]]
    for name, other in itertools.pairwise(names):
        yield Altered(f"no {name}", gone(f"tasks/{name}"), accepted=False)
        yield Altered(f"{name} has no claim", gone(f"tasks/{name}/certificate.json"), False)
        yield Altered(f"{name} is {other}", partial(exchanged, name=name, other=other), False)
        yield Altered(f"{name} is a link", link(f"tasks/{name}"), None)
        yield Altered(
            f"the claim of {name}, that of {other}",
            partial(exchanged, name=name, other=other, only=True),
            False,
        )
        for shift in ("0.000001", "0.1", "-0.000001"):
            yield Altered(
                f"a length of {name} by {shift}", partial(shifted, name=name, shift=shift), False
            )


def overwrite(path: Path, data: bytes) -> None:
    path.write_bytes(data)


def exchanged(folder: Path, name: str, other: str, *, only: bool = False) -> None:
    """The design of a task, or its certificate only, is that of another one."""
    one, source = folder / "tasks" / name, folder / "tasks" / other
    if only:
        shutil.copy(source / "certificate.json", one / "certificate.json")
        (one / "design.json").unlink()
        return
    shutil.rmtree(one)
    shutil.copytree(source, one)


def shifted(folder: Path, name: str, shift: str) -> None:
    """A length of a design is another one; without lengths its robustness is."""

    def change(content: Content) -> None:
        found = content["parameters"]
        if found:
            found[0]["value"] = str(float(Fraction(found[0]["value"]) + Fraction(shift)))
        else:
            content["robustness"] = "1000"

    changed(folder / "tasks" / name, change, "certificate.json")
    (folder / "tasks" / name / "design.json").unlink()


def alterations(folder: Path) -> list[Altered]:
    claim = read(folder, CLAIM)
    return [
        *of_numbers(claim),
        *of_kind(claim),
        *of_bounds(claim),
        *of_structures(claim),
        *of_trees(claim),
        *of_files(claim, folder),
    ]
