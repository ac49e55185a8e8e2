"""The documentation site: no warning, nothing loaded from elsewhere, links that lead on."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from html.parser import HTMLParser
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import unquote, urlparse

import pytest

from srgc.version import VERSION
from tests.oracles.axe import serious, show, source
from tests.oracles.browsers import start
from tests.oracles.linked_words import Article, Word, means, singular

pytestmark = pytest.mark.site

ROOT = Path(__file__).parents[1]
LOADED = {
    ("audio", "src"), ("embed", "src"), ("iframe", "src"), ("image", "href"), ("img", "src"),
    ("img", "srcset"), ("input", "src"), ("link", "href"), ("object", "data"), ("script", "src"),
    ("source", "src"), ("source", "srcset"), ("track", "src"), ("use", "href"), ("video", "src"),
}  # fmt: skip
"""What a browser fetches by itself."""


@dataclass
class Page(HTMLParser):
    """What a page loads, where it links to, and the fragments that it has."""

    file: Path
    loads: list[str] = field(default_factory=list)
    links: list[str] = field(default_factory=list)
    names: set[str] = field(default_factory=set)
    tags: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        super().__init__()
        self.feed(self.file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        for key, value in attrs:
            if (tag, key) in LOADED:
                self.loads.append(value or "")
            if tag == "a" and key == "href":
                self.links.append(value or "")
            if key in ("id", "name"):
                self.names.add(value or "")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site that `make docs` has built; else one without the notebooks' outputs."""
    if built := os.environ.get("SRGC_DOCS_BUILT"):
        return ROOT / built
    target = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-n", "-q", "-b", "html"]
    done = subprocess.run(
        [*command, "-d", str(target / "trees"), str(ROOT / "docs"), str(target / "html")],
        env={**os.environ, "SRGC_DOCS_RUN": "off"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-5000:]
    assert not done.stderr
    return target / "html"


@pytest.fixture(scope="module")
def read(site: Path) -> dict[Path, Page]:
    return {file: Page(file) for file in sorted(site.rglob("*.html"))}


def test_nothing_is_loaded_from_elsewhere(site: Path, read: dict[Path, Page]) -> None:
    for file, page in read.items():
        for address in page.loads:
            parts = urlparse(address)
            assert parts.scheme in ("", "data"), (file.name, address)
            assert not parts.netloc, (file.name, address)
            if parts.path and not parts.scheme:
                assert (file.parent / unquote(parts.path)).exists(), (file.name, address)
    styles = "".join(file.read_text(encoding="utf-8") for file in site.rglob("*.css"))
    fetched = re.findall(r"url\(\s*['\"]?([^)'\"]+)|@import\s+['\"]([^'\"]+)", styles)
    assert fetched or styles
    assert not [a or b for a, b in fetched if urlparse(a or b).netloc]


def test_links_lead_to_pages_and_places(site: Path, read: dict[Path, Page]) -> None:
    for file, page in read.items():
        for address in page.links:
            parts = urlparse(address)
            if parts.scheme or parts.netloc:
                continue
            target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            assert target.exists(), (file.name, address)
            if parts.fragment and target in read:
                assert unquote(parts.fragment) in read[target].names, (file.name, address)


def test_a_playground_that_is_built_is_linked(site: Path, read: dict[Path, Page]) -> None:
    if not (ROOT / "out" / "playground" / "index.html").is_file():
        pytest.skip("the playground is not built: run `make playground`")
    assert "playground/index.html" in read[site / "index.html"].links
    assert "../playground/index.html" in read[site / "how-to" / "playground.html"].links


def test_formulas_need_no_script(site: Path, read: dict[Path, Page]) -> None:
    assert "math" in read[site / "explanation" / "theory.html"].tags
    assert not [file for file in site.rglob("*") if "mathjax" in file.name.lower()]


def test_every_page_is_in_the_table_of_contents(site: Path) -> None:
    """Sphinx warns of a page that no table names; here are pages that there have to be."""
    for page in ("tutorial", "how-to/gravity", "reference/codes", "explanation/theory"):
        assert (site / f"{page}.html").is_file()
    assert len([*site.glob("decisions/0*.html")]) == len([*ROOT.glob("docs/decisions/0*.md")])


def test_commands_are_described_with_their_options(site: Path) -> None:
    text = (site / "reference" / "commands.html").read_text(encoding="utf-8")
    for option in ("synth-jobs", "graph-highlight", "verify-trust"):
        assert f'id="cmdoption-srgc-{option}"' in text


def test_specs_are_coloured_by_our_lexer(site: Path) -> None:
    text = (site / "index.html").read_text(encoding="utf-8")
    assert '<div class="highlight-srg' in text
    assert '<span class="kd">module</span>' in text


def test_pages_say_of_which_version_they_are(site: Path) -> None:
    for page in ("index", "how-to/install"):
        text = (site / f"{page}.html").read_text(encoding="utf-8")
        brand = re.search(r'<span class="sidebar-brand-text">(.*?)</span>', text)
        assert brand
        assert brand[1] == f"srgc {VERSION}"


# --- the first use of a term on a page leads to the glossary -------------------------------------


PHRASES = [["in", "words"], ["in", "other", "words"], ["python", "module"], ["same", "words"]]
"""They contain a term and do not mean it."""


@pytest.fixture(scope="module")
def articles(site: Path) -> dict[str, Article]:
    files = sorted(site.rglob("*.html"))
    return {str(f.relative_to(site).with_suffix("")): Article(f) for f in files}


@pytest.fixture(scope="module")
def glossary(articles: dict[str, Article]) -> dict[str, list[list[str]]]:
    """The forms of each term, as words, by the name of its row."""
    found: dict[str, list[list[str]]] = {}
    for target, shown in articles["reference/glossary"].rows.items():
        name, _, bracket = shown.partition("(")
        short = bracket.strip(") ")
        forms = [name.lower(), short] if short.isupper() else [name.lower()]
        found[target] = [re.findall(r"[\w-]+", form) for form in forms]
    assert len(found) > 90
    return found


def linked(article: Article) -> dict[str, list[str]]:
    """The words of each link to the glossary; a second link to one row is a second entry."""
    found: dict[tuple[str, int], list[str]] = {}
    for word in article.words:
        if word.target:
            found.setdefault((word.target, word.run), []).append(word.text)
    targets = [target for target, _ in found]
    assert len(targets) == len(set(targets)), article.file
    return {target.partition("#")[2]: words for (target, _), words in found.items()}


def other_senses() -> dict[str, set[str]]:
    """The exceptions that the extension states, read as data."""
    text = (ROOT / "docs" / "_extensions" / "glossary_links.py").read_text(encoding="utf-8")
    [value] = [
        node.value
        for node in ast.parse(text).body
        if isinstance(node, ast.AnnAssign) and ast.unparse(node.target) == "OTHER_SENSES"
    ]
    assert isinstance(value, ast.Dict)
    return {
        ast.literal_eval(key): set(ast.literal_eval(given.args[0]))
        for key, given in zip(value.keys, value.values, strict=True)
        if key is not None and isinstance(given, ast.Call)
    }


def uses(words: list[Word], forms: dict[str, list[list[str]]]) -> Iterator[tuple[str, int]]:
    """Where terms stand outside links and code: of two that begin at one word the longer one."""
    every = [(target, form) for target, some in forms.items() for form in some]
    every += [("", phrase) for phrase in PHRASES]
    every.sort(key=lambda one: -len(one[1]))
    begins: dict[str, list[tuple[str, list[str]]]] = {}
    for one in every:
        begins.setdefault(one[1][0].lower(), []).append(one)
    place = 0
    while place < len(words):
        near = singular(words[place].text.lower())
        for target, form in [one for key in sorted(near) for one in begins.get(key, ())]:
            here = words[place : place + len(form)]
            if (
                len({word.run for word in here}) == 1
                and here[0].free
                and means([word.text for word in here], form)
            ):
                if target:
                    yield target, place
                place += len(form) - 1
                break
        place += 1


def test_links_to_the_glossary_lead_to_their_terms(
    articles: dict[str, Article], glossary: dict[str, list[list[str]]]
) -> None:
    everywhere: set[str] = set()
    for name, article in articles.items():
        assert article.misplaced == [], name
        found = linked(article)
        assert not found or not name.startswith(("decisions/", "reference/glossary")), name
        for target, words in found.items():
            assert any(means(words, form) for form in glossary[target]), (name, target, words)
        everywhere |= found.keys()
    assert len(everywhere) >= 50
    assert {"term-cell", "term-counterexample"} <= linked(articles["how-to/planning"]).keys()


def test_the_first_use_of_a_term_is_the_one_that_is_linked(
    articles: dict[str, Article], glossary: dict[str, list[list[str]]]
) -> None:
    everywhere = {target for article in articles.values() for target in linked(article)}
    exceptions = {
        name: {"-".join(["term", *re.findall(r"[a-z0-9]+", term.lower())]) for term in some}
        for name, some in other_senses().items()
    }
    everywhere = everywhere.union(*exceptions.values())
    forms = {target: some for target, some in glossary.items() if target in everywhere}
    for name, article in articles.items():
        if name.startswith("decisions/") or name in {"reference/glossary", "genindex", "search"}:
            continue
        first = {}
        for place, word in enumerate(article.words):
            if word.target:
                first.setdefault(word.target.partition("#")[2], place)
        left_out = exceptions.get(name, set())
        met = set()
        for target, place in uses(article.words, forms):
            met.add(target)
            if target not in left_out:
                near = " ".join(word.text for word in article.words[place - 5 : place + 6])
                assert place > first.get(target, len(article.words)), (name, target, near)
        assert left_out <= met, name
        assert not left_out & first.keys(), name


def test_the_page_of_the_search_has_a_heading_and_a_field(site: Path) -> None:
    text = (site / "search.html").read_text(encoding="utf-8")
    assert "<h1>Search</h1>" in text
    article = text.partition('<article role="main"')[2]
    assert re.search(r'<input type="search" name="q" aria-label="Search"', article)


# --- the site in a browser -----------------------------------------------------------------------


SOUGHT = {
    "payload": "how-to/drives.html",
    "collision": "how-to/whole-body.html",
    "URDF": "how-to/import.html",
    "feedback": "how-to/controller.html",
    "price": "how-to/objectives.html",
}
FIRST_SCREEN = 8
"""Results that a window of 900 pixels shows without scrolling."""


class Quiet(SimpleHTTPRequestHandler):
    def log_message(self, format: str, *arguments: object) -> None:  # noqa: A002
        """Say nothing."""


@pytest.fixture(scope="module")
def address(site: Path) -> Iterator[str]:
    """Where the site is served while the tests run."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(site)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    server.server_close()


def test_the_search_finds_what_people_look_for(
    address: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    driver = start(tmp_path_factory.mktemp("profile"))
    try:
        for word, page in SOUGHT.items():
            driver.get(f"{address}/search.html?q={word}")
            found: list[str] = []
            end = time.monotonic() + 120
            while time.monotonic() < end and not driver.find_elements(
                "css selector", "#search-results ul.search li a"
            ):
                time.sleep(0.2)
            shown = driver.find_elements("css selector", "#search-results ul.search li")
            for result in shown[:FIRST_SCREEN]:
                link = result.find_element("css selector", "a").get_attribute("href")
                found.append(urlparse(link).path.lstrip("/"))
            assert page in found, (word, found)
    finally:
        driver.quit()


SCREENS = [(320, "light"), (1280, "dark")]
LARGE = 300_000
"""Bytes of a page on which axe-core takes many seconds; there are three, mostly tables."""


@pytest.fixture(scope="module")
def pages(site: Path) -> list[Path]:
    """All pages but the decision records, which are alike."""
    files = [file.relative_to(site) for file in sorted(site.rglob("*.html"))]
    found = [f for f in files if "decisions" not in f.parts or f.name == "index.html"]
    assert len(found) > 60
    return found


def faults(
    address: str, pages: list[Path], profile: Path, screen: tuple[int, str]
) -> dict[str, list[str]]:
    """What is seriously wrong with each page on that screen, or that it is wider than it."""
    axe = source()
    driver = start(profile)
    found: dict[str, list[str]] = {}
    try:
        driver.set_script_timeout(120)
        show(driver, *screen)
        for page in pages:
            driver.get(f"{address}/{page.as_posix()}")
            wide = driver.execute_script("return document.documentElement.scrollWidth;")
            found[str(page)] = serious(driver, axe) + [f"{wide} pixels wide"] * (wide > screen[0])
    finally:
        driver.quit()
    return {page: each for page, each in found.items() if each}


@pytest.mark.parametrize("part", [0, 1])
def test_no_page_has_a_serious_fault(
    address: str, site: Path, pages: list[Path], tmp_path: Path, part: int
) -> None:
    """Every second page on one screen, the others on the other one."""
    usual = [page for page in pages if (site / page).stat().st_size < LARGE]
    assert faults(address, usual[part::2], tmp_path, SCREENS[part]) == {}


@pytest.mark.slow
@pytest.mark.parametrize("screen", SCREENS)
def test_no_page_has_a_serious_fault_on_any_screen(
    address: str, pages: list[Path], tmp_path: Path, screen: tuple[int, str]
) -> None:
    assert faults(address, pages, tmp_path, screen) == {}
