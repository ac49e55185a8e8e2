"""The page in a real browser: it asks nobody else, bears any text, fits a phone, can be shared."""

from __future__ import annotations

import threading
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest

from tests.browser.test_whole_page import CONTRASTS
from tests.oracles.axe import SEEN, serious, show, source
from tests.oracles.small_specs import TURNER
from tests.playground.conftest import ROOT, Playground

pytestmark = pytest.mark.playground

HOSTILE = "<img src=x onerror=hacked()><script>hacked()</script></pre><b>"
Reopened = Callable[[str], Playground]


def test_nothing_is_asked_of_others(reopened: Reopened, address: str) -> None:
    page = reopened("")
    page.complaints()
    page.requests()
    page = reopened("")
    assert page.ask(ask="fmt", text=TURNER)["answer"]
    asked = page.requests()
    assert f"{address}examples.json" in asked
    assert all(each.startswith((address, f"blob:{address}", "data:", "about:")) for each in asked)
    assert page.complaints() == []


@pytest.mark.parametrize("within", ["page", "worker"])
def test_the_browser_lets_nothing_out(page: Playground, within: str) -> None:
    """Neither the page nor a worker that it starts can fetch from elsewhere; nor is it tried."""
    heard = []

    class Elsewhere(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            heard.append(self.path)
            self.send_response(200)
            self.send_header("Access-Control-Allow-Origin", "*")
            self.end_headers()

        def log_message(self, *_: object) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Elsewhere)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    fetching = f"fetch('http://127.0.0.1:{server.server_port}/').then(() => 'out', () => 'refused')"
    script = (
        f"{fetching}.then(arguments[0]);"
        if within == "page"
        else f"""
        const text = "{fetching}.then((found) => postMessage(found));";
        const blob = URL.createObjectURL(new Blob([text], {{ type: "text/javascript" }}));
        new Worker(blob, {{ type: "module" }}).onmessage = (event) => arguments[0](event.data);
        """
    )
    try:
        assert page.driver.execute_async_script(script) == "refused"
        assert heard == []
    finally:
        server.shutdown()
        server.server_close()
        page.complaints()


def test_typing_changes_the_findings(page: Playground) -> None:
    """Every key is answered, and what is shown in the end is about the text in the end."""
    from selenium.webdriver.common.keys import Keys

    assert "without errors" in page.show(TURNER)
    editor = page.one(".cm-content")
    editor.click()
    editor.send_keys(Keys.CONTROL, Keys.END)
    editor.send_keys("mod")
    page.wait("document.querySelector('.cm-tooltip-autocomplete')")
    assert "module" in page.text(".cm-tooltip-autocomplete")
    editor.send_keys(Keys.ESCAPE, "ule B { role base; ", Keys.ESCAPE)
    page.wait("document.getElementById('findings').textContent.includes('SRG0202')")
    assert page.text("#status") == "1 error."
    assert page.all(".cm-lintRange-error")
    page.all("#findings button")[1].click()
    assert page.one("#tab-explain").get_attribute("aria-selected") == "true"
    page.wait("document.getElementById('explained').textContent.startsWith('# SRG0202')")


def test_a_finding_leads_to_its_place(page: Playground) -> None:
    page.show(TURNER.replace("reach T", "reach Nowhere"))
    page.one("#findings button").click()
    line = page.run("return document.querySelector('.cm-activeLine').textContent;")
    assert "reach Nowhere" in line


def test_apply_formats(page: Playground) -> None:
    page.show(TURNER.replace(";", "  ;"))
    page.one("#tab-fmt").click()
    page.wait("!document.getElementById('apply').disabled")
    page.one("#apply").click()
    page.wait("document.getElementById('apply').disabled")
    assert page.run("return playground.text;") == page.text("#formatted")


def test_a_graph_is_drawn(page: Playground) -> None:
    page.show(TURNER)
    page.one("#tab-graph").click()
    page.wait("document.getElementById('picture').naturalWidth")
    page.run(
        "playground.text = arguments[0];", TURNER.replace("Turner", "Other").replace("EN", "TIP")
    )
    page.wait("document.getElementById('dot').textContent.includes('TIP')")
    page.run("document.getElementById('of').value = 'words';")
    page.one("#word").send_keys("B eps")
    page.wait("!document.getElementById('drawn-fault').hidden")
    assert "B eps" in page.text("#drawn-fault")
    page.one("#word").clear()


def test_hostile_texts_are_texts(page: Playground) -> None:
    page.run("window.hacked = () => { window.wasHacked = true; };")
    for text in (
        TURNER.replace("reach T", f'include "{HOSTILE}"; reach T'),
        f'include "{HOSTILE}";',
        f"// {HOSTILE}\n{HOSTILE}",
        f"{TURNER}\x00\x1b[31m\u202e\ud83e\udd16",
    ):
        page.show(text)
        for tab in ("fmt", "graph", "explain"):
            page.one(f"#tab-{tab}").click()
        page.one("#code").clear()
        page.one("#code").send_keys(HOSTILE, "\ue007")
        page.wait("document.getElementById('explained').textContent.includes('hacked')")
    assert page.run("return window.wasHacked;") is None
    assert page.all("#result img:not(#picture), #result script, #result b") == []


def test_a_link_holds_the_spec(reopened: Reopened) -> None:
    page = reopened("")
    text = f"// \N{ROBOT FACE} äöü\n{TURNER}"
    page.show(text)
    page.one("#share").click()
    page.wait("location.hash.startsWith('#spec=')")
    fragment = page.run("return location.hash;")
    assert len(fragment) < len(text)
    assert reopened(fragment).run("return playground.text;") == text


@pytest.mark.parametrize("name", ["cheapest_arm", "l_shaped"])
def test_a_first_spec_that_needs_what_comes_later(reopened: Reopened, name: str) -> None:
    """Modules that the first archive does not have, and python-flint after them."""
    text = (ROOT / "specs" / f"{name}.srg").read_text(encoding="utf-8")
    page = reopened("")
    page.show(text)
    page.one("#share").click()
    page.wait("location.hash.startsWith('#spec=')")
    page = reopened(page.run("return location.hash;"))
    assert page.run("return playground.text;") == text
    assert page.one("#findings").text.endswith("1 file without errors")


def test_a_broken_link_says_so(reopened: Reopened) -> None:
    page = reopened("#spec=AAAA")
    assert "module Base" in page.run("return playground.text;")


def test_a_run_can_be_stopped(page: Playground) -> None:
    """A grammar that takes long; what comes after is answered by another worker."""
    long = "\n".join(f"module M{i} {{ role link; param a in [1, 2] m; }}" for i in range(15_000))
    page.run("playground.text = arguments[0];", long)
    page.wait("!document.getElementById('stop').hidden")
    page.one("#stop").click()
    page.wait("document.body.dataset.state === 'ready'")
    assert "without errors" in page.show(TURNER)


@pytest.mark.parametrize("width", [320, 768])
def test_a_phone_does_not_scroll_sideways(page: Playground, width: int) -> None:
    page.show(TURNER)
    page.command(
        "Emulation.setDeviceMetricsOverride",
        width=width, height=640, deviceScaleFactor=1, mobile=True,
    )  # fmt: skip
    for tab in ("check", "fmt", "graph", "explain"):
        page.one(f"#tab-{tab}").click()
        assert page.run("return document.documentElement.scrollWidth;") <= width


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_contrast(page: Playground, scheme: str) -> None:
    page.media("screen", prefers_color_scheme=scheme)
    page.show(TURNER.replace("reach T", "reach Nowhere"))
    for tab in ("check", "fmt", "graph", "explain"):
        page.one(f"#tab-{tab}").click()
        assert page.run(CONTRASTS) == []


@pytest.mark.parametrize(("width", "colours"), SEEN)
def test_no_serious_finding(page: Playground, width: int, colours: str) -> None:
    page.show(TURNER.replace("reach T", "reach Nowhere"))
    show(page.driver, width, colours)
    for tab in ("check", "fmt", "graph", "explain"):
        page.one(f"#tab-{tab}").click()
        assert serious(page.driver, source()) == [], tab


def test_keys_alone(page: Playground) -> None:
    """Arrows go through the tabs, everything has a name, and the state is announced."""
    from selenium.webdriver.common.keys import Keys

    page.show(TURNER)
    page.one("#tab-check").send_keys(Keys.ARROW_LEFT)
    assert page.one("#tab-explain").get_attribute("aria-selected") == "true"
    page.one("#tab-explain").send_keys(Keys.HOME)
    assert page.one("#check").is_displayed()
    assert page.one("#status").get_attribute("role") == "status"
    unnamed = page.run(
        "return [...document.querySelectorAll('button, select, input, [role=tabpanel], section')]"
        ".filter((e) => !(e.textContent.trim() || e.getAttribute('aria-label') || e.labels?.length"
        " || e.getAttribute('aria-labelledby'))).map((e) => e.id);"
    )
    assert unnamed == []
