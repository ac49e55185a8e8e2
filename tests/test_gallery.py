"""The gallery: its examples are of all kinds, and its page shows what was measured of them."""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest

from benchmarks.gallery import Gallery, Ran, chosen, code_digest, run_process
from docs._extensions.gallery_page import (
    GALLERY,
    MADE,
    Example,
    Step,
    copy_reports,
    page,
    read_examples,
    read_run,
    with_reports,
)
from srgc.cli import run
from tests.oracles.small_specs import BEYOND_REACH, TURNER
from tests.srgc.test_shipped_specs import SPECS
from tests.test_documentation import assert_alike

ROOT = Path(__file__).parents[1]
SVG = "{http://www.w3.org/2000/svg}"
KINDS = {
    "planar", "spatial", "gantry", "SCARA", "UR5", "Timor", "cart", "drone", "branching",
    "reconfiguration", "for ever", "disturbances", "cheapest", "impossible", "map", "mesh",
}  # fmt: skip
"""What a gallery has to have at least."""
EXAMPLES = {example.name: example for example in read_examples()}
RUNS = {
    name: known for name, example in EXAMPLES.items() if (known := read_run(example)) is not None
}
CHEAP = ["planar_arm", "cheapest_arm", "far_shelf"]
"""Those that other tests synthesize, too, or that take seconds."""


# --- what is kept ---------------------------------------------------------------------------------


def test_every_kind_has_an_example() -> None:
    assert {example.kind for example in EXAMPLES.values()} >= KINDS
    assert len(EXAMPLES) == len(read_examples()) >= 16
    assert set(RUNS) == set(EXAMPLES)


def test_their_specs_are_tested() -> None:
    """That they check and are formatted, tests/srgc/test_shipped_specs.py tests."""
    assert {ROOT / example.spec for example in EXAMPLES.values()} <= set(SPECS)


def test_the_page_is_what_the_program_writes() -> None:
    assert (GALLERY / "index.md").read_text(encoding="utf-8") == page(read_examples(), RUNS)


def test_nothing_else_is_kept() -> None:
    assert {file.stem for file in (GALLERY / "runs").glob("*.json")} == set(RUNS)
    assert {file.stem for file in GALLERY.glob("*.svg")} == set(RUNS)


@pytest.mark.parametrize("name", RUNS)
def test_runs_are_of_the_specs_as_they_are(name: str) -> None:
    known, example = RUNS[name], EXAMPLES[name]
    assert known.commands == example.commands
    assert known.printed[0].startswith(f"verdict: {example.verdict}")
    assert Path(example.spec).name in known.files
    for file, digest in known.files.items():
        content = (ROOT / "specs" / file).read_bytes()
        assert hashlib.sha256(content).hexdigest().startswith(digest), file
    assert all(step.seconds > 0 < step.peak for step in known.steps.values())
    assert str(ROOT) not in known.text()


@pytest.mark.parametrize("name", RUNS)
def test_pictures_are_small_have_a_title_and_move(name: str) -> None:
    file = GALLERY / f"{name}.svg"
    assert file.stat().st_size <= 150_000
    root = ElementTree.parse(file).getroot()
    assert root.tag == f"{SVG}svg"
    assert root.get("role") == "img"
    assert (root.findtext(f"{SVG}title") or "").strip()
    assert {"script", "image", "use", "foreignObject"}.isdisjoint(
        node.tag.removeprefix(SVG) for node in root.iter()
    )
    moves = root.find(f".//{SVG}animate") is not None
    assert moves == (EXAMPLES[name].verdict == "found")


def test_pictures_have_a_text_in_their_place() -> None:
    text = (GALLERY / "index.md").read_text(encoding="utf-8")
    assert text.count("![") == len(RUNS)
    assert "![]" not in text


# --- the same anew --------------------------------------------------------------------------------


@pytest.mark.parametrize("name", CHEAP)
def test_verdict_and_picture_are_the_same_again(
    name: str, made: Callable[[str], Path], tmp_path: Path
) -> None:
    example, folder, drawn = EXAMPLES[name], made(name) / "out", tmp_path / "drawn.svg"
    design = json.loads((folder / "design.json").read_text(encoding="utf-8"))
    assert design["verdict"] == example.verdict
    assert run(["verify", str(folder), "--spec", str(ROOT / example.spec)]) == 0
    if example.verdict == "found":
        assert run(["export", str(folder), "--to", "svg", "-o", str(drawn)]) == 0
    else:
        assert run(["plan", str(ROOT / example.spec), "-o", str(drawn)]) == 0
    if name in RUNS:
        assert_alike(drawn, GALLERY / f"{name}.svg")


@pytest.mark.slow
@pytest.mark.parametrize("name", EXAMPLES)
def test_every_example_runs_again(name: str, tmp_path: Path) -> None:
    """In the folder of the checkout, as its commands say; pictures and runs go elsewhere."""
    anew = Gallery(folder=tmp_path).make(EXAMPLES[name], "none")
    assert set(anew.steps) == set(EXAMPLES[name].commands)
    if name in RUNS:
        assert anew.printed[0] == RUNS[name].printed[0]
        assert anew.files == RUNS[name].files
        assert_alike(tmp_path / f"{name}.svg", GALLERY / f"{name}.svg")


# --- the program ----------------------------------------------------------------------------------

DRAWN = '<svg xmlns="http://www.w3.org/2000/svg"/>'


class Shop:
    """A gallery of two examples, whose commands write files and are counted."""

    def __init__(self, root: Path) -> None:
        self.root, self.ran = root, list[str]()
        self.verdict, self.drawn = "found", DRAWN
        (root / "specs").mkdir()
        for name in ("one", "two"):
            (root / "specs" / f"{name}.srg").write_text(f"{name}\n", encoding="utf-8")
        (root / "docs").mkdir()
        (root / "docs" / "examples.toml").write_text(
            "".join(
                f'[[example]]\nkind = "planar"\ntitle = "No. {name}"\nspec = "specs/{name}.srg"\n'
                f'says = "It is {name}."\n'
                for name in ("one", "two")
            ),
            encoding="utf-8",
        )
        self.gallery = Gallery(root, root / "docs", self.run)
        self.one, self.two = read_examples(root / "docs")

    def run(self, command: str) -> Ran:
        self.ran.append(command)
        kind, first, *more = command.split()
        last = more[-1] if more else first
        if kind == "synth":
            (self.root / last / "spec").mkdir(parents=True)
            shutil.copy(self.root / first, self.root / last / "spec")
            design = json.dumps({"verdict": self.verdict})
            (self.root / last / "design.json").write_text(design, encoding="utf-8")
        elif kind == "report":
            (self.root / last / "report.html").write_text("<p>", encoding="utf-8")
        elif kind == "export":
            (self.root / last).write_text(self.drawn, encoding="utf-8")
        printed = ["verdict: found", "robot:   A B", "effort:  none"]
        return Ran(0, printed, "", Step(2.0, 1.9, 100))


@pytest.fixture
def shop(tmp_path: Path) -> Shop:
    return Shop(tmp_path)


def test_a_finished_example_is_kept_until_something_changes(shop: Shop) -> None:
    assert not shop.gallery.is_finished(shop.one, "code")
    shop.gallery.make(shop.one, "code")
    assert shop.gallery.is_finished(shop.one, "code")
    assert not shop.gallery.is_finished(shop.two, "code")
    assert not shop.gallery.is_finished(shop.one, "other code")
    assert not shop.gallery.is_finished(replace(shop.one, verdict="impossible"), "code")
    report = shop.root / MADE / "one" / "report.html"
    report.unlink()
    assert not shop.gallery.is_finished(shop.one, "code")
    report.touch()
    (shop.root / "specs" / "one.srg").write_text("edited\n", encoding="utf-8")
    assert not shop.gallery.is_finished(shop.one, "code")


def test_a_synthesis_begins_anew(shop: Shop) -> None:
    rest = shop.root / MADE / "one" / "journal.jsonl"
    rest.parent.mkdir(parents=True)
    rest.touch()
    shop.gallery.make(shop.one, "code")
    assert not rest.exists()
    assert [command.split()[0] for command in shop.ran] == ["synth", "verify", "export", "report"]


def test_what_is_kept_of_a_run(shop: Shop) -> None:
    shop.gallery.make(shop.one, "code")
    shop.gallery.write_page()
    known = read_run(shop.one, shop.root / "docs")
    assert known is not None
    assert known.printed == ["verdict: found", "robot:   A B"]
    assert set(known.files) == {"one.srg"}
    assert (shop.root / "docs" / "one.svg").read_text(encoding="utf-8") == DRAWN
    text = (shop.root / "docs" / "index.md").read_text(encoding="utf-8")
    assert text == page([shop.one, shop.two], {"one": known})
    assert "| [No. one](#no-one) | found | 2.0 s | 2.0 s | 100 MiB |" in text
    assert "| [No. two](#no-two) | not yet run |" in text
    assert "†" not in text


def test_a_busy_machine_is_told(shop: Shop) -> None:
    known = shop.gallery.make(shop.one, "code")
    steps = {**known.steps, "verify": Step(10.0, 3.0, 100)}
    text = page([shop.one], {"one": replace(known, steps=steps)})
    assert "| 2.0 s | 3.0 s† | 100 MiB |" in text
    assert "†: time of the processor" in text


def test_what_is_no_example_for_the_gallery(shop: Shop) -> None:
    shop.verdict = "unknown"
    with pytest.raises(SystemExit, match="unknown, not found"):
        shop.gallery.make(shop.one, "code")
    shop.verdict, shop.drawn = "found", DRAWN + " " * 150_000
    with pytest.raises(SystemExit, match="a picture of 15"):
        shop.gallery.make(shop.one, "code")
    with pytest.raises(SystemExit, match="exit status 0, not 3"):
        shop.gallery.make(replace(shop.one, verdict="impossible"), "code")
    assert not (shop.root / "docs" / "runs").exists()


def test_every_example_is_in_one_shard() -> None:
    examples = read_examples()
    parts = [chosen(examples, [], f"{k}/3") for k in (1, 2, 3)]
    assert sorted(each.name for part in parts for each in part) == sorted(EXAMPLES)
    assert chosen(examples, ["far_shelf"], "1/1") == [EXAMPLES["far_shelf"]]
    for shard in ("0/3", "4/3", "3", "a/b"):
        with pytest.raises(SystemExit, match="expected K/N"):
            chosen(examples, [], shard)
    with pytest.raises(SystemExit, match="no example is called robot"):
        chosen(examples, ["robot"], "1/1")


def test_the_code_has_another_digest_when_it_changes(tmp_path: Path) -> None:
    file = tmp_path / "srgc" / "a.py"
    file.parent.mkdir()
    file.write_text("a = 1\n", encoding="utf-8")
    before = code_digest(tmp_path)
    (file.parent / "a.pyc").touch()
    assert code_digest(tmp_path) == before
    file.write_text("a = 2\n", encoding="utf-8")
    assert code_digest(tmp_path) != before


def test_reports_are_linked_where_there_are_some(tmp_path: Path) -> None:
    text = page(read_examples(), {})
    made, site = tmp_path / "made", tmp_path / "site"
    assert "<a " not in with_reports(text, made)
    assert "<!-- report" not in with_reports(text, made)
    (made / "far_shelf").mkdir(parents=True)
    (made / "far_shelf" / "report.html").write_text("<p>", encoding="utf-8")
    linked = with_reports(text, made)
    assert linked.count("<a ") == 1
    assert 'href="reports/far_shelf.html"' in linked
    copy_reports(made, site)
    assert [file.name for file in site.rglob("*.html")] == ["far_shelf.html"]
    assert (site / "gallery" / "reports" / "far_shelf.html").is_file()


@pytest.mark.parametrize(
    ("text", "verdict"),
    [(TURNER, "found"), (BEYOND_REACH, "impossible")],
    ids=["found", "impossible"],
)
def test_a_small_example_from_spec_to_page(text: str, verdict: str, tmp_path: Path) -> None:
    """With the real commands, which find what the spec is made for."""
    (tmp_path / "specs").mkdir()
    (tmp_path / "specs" / "small.srg").write_text(text, encoding="utf-8")
    example = Example("planar", "A small one", "specs/small.srg", "It is small.", verdict)

    def ran(command: str) -> Ran:
        return run_process(command, root=tmp_path)

    known = Gallery(tmp_path, tmp_path / "docs", ran).make(example, "code")
    assert known.printed[0].startswith(f"verdict: {verdict}")
    assert all(step.seconds > 0 and 20 < step.peak < 4000 for step in known.steps.values())
    assert (tmp_path / MADE / "small" / "report.html").is_file()
    root = ElementTree.parse(tmp_path / "docs" / "small.svg").getroot()
    assert root.tag == f"{SVG}svg"


def test_a_command_that_takes_too_long_is_ended(tmp_path: Path) -> None:
    (tmp_path / "small.srg").write_text(TURNER, encoding="utf-8")
    assert run_process("synth small.srg -o out", limit=0.01, root=tmp_path).status < 0
