"""Where no browser is installed, these tests are skipped; where one is required, they fail."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.oracles.browsers import start


def test_missing_browser_skips(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("SRGC_BROWSER", raising=False)
    with pytest.raises(pytest.skip.Exception, match="no Chromium"):
        start(tmp_path)


def test_missing_browser_fails_where_it_is_required(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("SRGC_BROWSER", "required")
    with pytest.raises(pytest.fail.Exception, match="no Chromium"):
        start(tmp_path)
