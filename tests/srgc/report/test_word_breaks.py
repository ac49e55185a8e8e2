"""Long names may be broken between their words, and nothing else changes."""

from __future__ import annotations

import pytest

from srgc.report.word_breaks import with_breaks


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("CarbonFibreForearm", ["Carbon", "Fibre", "Forearm"]),
        ("left_upper_arm_link", ["left_", "upper_", "arm_", "link"]),
        ("LongHTTPServerModule.length", ["Long", "HTTP", "Server", "Module.", "length"]),
        ("out/gallery/two_arm", ["out/", "gallery/", "two_", "arm"]),
        ("supercalifragilistic", ["supercalifragilistic"]),
        ("ForearmLink", ["ForearmLink"]),
    ],
)
def test_names_are_broken_between_their_words(name: str, parts: list[str]) -> None:
    broken = "<wbr>".join(parts)
    if len(parts) > 1:
        broken = f'<span class="long-name">{broken}</span>'
    assert with_breaks(f"<p>{name} eps</p>") == f"<p>{broken} eps</p>"


def test_attributes_pictures_and_excerpts_stay_as_they_are() -> None:
    kept = (
        '<i title="CarbonFibreForearm"></i><svg><svg><text>CarbonFibreForearm</text></svg>'
        "<text>CarbonFibreForearm</text></svg><pre><code>CarbonFibreForearm</code></pre>"
        '<script type="application/json">"CarbonFibreForearm"</script>'
    )
    assert with_breaks(kept) == kept


def test_numbers_and_digests_have_no_breaks() -> None:
    kept = "<p>0.12345678901234567 941c011818bca7de20085924 &quot;a&quot; 1.5e-17</p>"
    assert with_breaks(kept) == kept
