"""The documentation site: no warning, nothing loaded from elsewhere, links that lead on."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlparse

import pytest

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
