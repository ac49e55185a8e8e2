"""Which words of a page become links to the glossary; expected values are written by hand."""

from __future__ import annotations

import pytest
from docutils import nodes

from docs._extensions.glossary_links import EVERYDAY, OTHER_SENSES, Linker, plural, terms
from tests.conftest import ROOT

GLOSSARY = """
| term | definition | symbol | in the code |
|---|---|---|---|
| cell | a closed polytope |  | `Cell` |
| cell trace | a sequence of cells |  | `SampledFormula` |
| configuration (of a robot) | a structure with values | (ω, θ) | `FoundDesign` |
| cut | a half-space |  | `Cut` |
| degree of freedom | a coordinate of a joint | q | `Dof` |
| reconfiguration automaton (FRA) | the SRA with rules | FRA | `Fra` |
| robot family | a grammar whose `derivations` are robots |  | `RobotFamily` |
"""


def paragraph(*parts: nodes.Node | str) -> nodes.document:
    """A document of one paragraph."""
    document = nodes.document(None, None)
    text = nodes.paragraph()
    text.extend(nodes.Text(part) if isinstance(part, str) else part for part in parts)
    document.append(text)
    return document


def linked(document: nodes.document, left_out: tuple[str, ...] = ()) -> list[tuple[str, str]]:
    """The text and the fragment of each link that was put into a document."""
    before = document.astext()
    Linker(terms(GLOSSARY)).link(document, "glossary.html", left_out)
    assert document.astext() == before
    return [
        (each.astext(), each["refuri"].removeprefix("glossary.html#term-"))
        for each in document.findall(nodes.reference)
        if "term" in each["classes"]
    ]


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("A cell, and another cell.", [("cell", "cell")]),
        ("Cells are convex.", [("Cells", "cell")]),
        ("The cell's side.", [("cell", "cell")]),
        ("A cell trace has cells.", [("cell trace", "cell-trace"), ("cells", "cell")]),
        ("Two degrees\nof freedom.", [("degrees\nof freedom", "degree-of-freedom")]),
        ("Robot families.", [("Robot families", "robot-family")]),
        ("An FRA.", [("FRA", "reconfiguration-automaton-fra")]),
        ("Save it as robot.fra, or Fra.", []),
        ("Reconfiguration automaton (FRA)",
         [("Reconfiguration automaton", "reconfiguration-automaton-fra")]),
        ("A supercell, a cell-wise rule, a multi-cell path, cellular.", []),
        ("A configuration of a robot; cut the rod.", []),
    ],
)  # fmt: skip
def test_the_first_use_of_each_term(text: str, found: list[tuple[str, str]]) -> None:
    assert linked(paragraph(text)) == found


def test_code_links_and_headings_stay_as_they_are() -> None:
    before = [
        nodes.literal("", "cell"),
        nodes.reference("", "a cell", refuri="elsewhere"),
        nodes.math("", "cell"),
    ]
    document = paragraph(*before, " and a cell")
    document.insert(0, nodes.title("", "Cells"))
    document.insert(1, nodes.literal_block("", "cell"))
    assert linked(document) == [("cell", "cell")]
    assert document.children[-1].children[-1].astext() == "cell"


def test_a_term_may_be_on_two_lines() -> None:
    document = paragraph("one degree of", "\n", "freedom")
    assert linked(document) == [("degree of\nfreedom", "degree-of-freedom")]


def test_a_page_may_mean_something_else() -> None:
    assert linked(paragraph("A cell in a robot family."), ("cell",)) == [
        ("robot family", "robot-family")
    ]


def test_a_link_says_what_the_term_means() -> None:
    document = paragraph("A robot family.")
    linked(document)
    [link] = document.findall(nodes.reference)
    assert link["reftitle"] == "a grammar whose derivations are robots"


@pytest.mark.parametrize(
    ("one", "many"),
    [("alphabet", "alphabets"), ("necessary condition", "necessary conditions"),
     ("trajectory", "trajectories"), ("degree of freedom", "degrees of freedom"),
     ("prefetch", "prefetches")],
)  # fmt: skip
def test_plurals(one: str, many: str) -> None:
    assert plural(one) == many


def test_exceptions_are_terms_and_pages() -> None:
    text = (ROOT / "docs" / "reference" / "glossary.md").read_text(encoding="utf-8")
    names = [line.split("|")[1].strip() for line in text.splitlines() if line.startswith("| ")][1:]
    assert set(names) >= EVERYDAY
    for page, some in OTHER_SENSES.items():
        assert (ROOT / "docs" / f"{page}.md").is_file()
        assert set(names) >= some
        assert not some & EVERYDAY
