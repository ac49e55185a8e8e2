"""Results of whole syntheses, made once for all tests of a session and handed out as copies."""

from __future__ import annotations

import gc
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from tests.oracles import small_specs
from tests.oracles.command_line import copied
from tests.oracles.small_missions import MISSIONS, SHOP
from tests.oracles.some_cases import OTHERS, USUAL
from tests.oracles.spatial_arm import SPATIAL

pytest_plugins = ["tests.long_tests", "tests.resumable"]

ROOT = Path(__file__).parents[1]
WAIT_SECONDS = 900
COMMAND = (sys.executable, "-c", "from srgc.cli import main; main()")

SPECS = {
    **{path.stem: path.read_bytes() for path in sorted((ROOT / "specs").glob("*.srg"))},
    **{path.stem: path.read_bytes() for path in sorted((ROOT / "srgc" / "starters").glob("*.srg"))},
    "turner": small_specs.TURNER.encode(),
    "motor": small_specs.MOTOR.encode(),
    "slider": small_specs.SLIDER.encode(),
    "beyond_reach": small_specs.BEYOND_REACH.encode(),
    "learnt": small_specs.BEYOND_REACH.encode(),
    "good_as_it_is": small_specs.GOOD_AS_IT_IS.encode(),
    "closed": small_specs.CLOSED.encode(),
    "plotter": small_specs.PLOTTER.encode(),
    "pair": small_specs.PAIR.encode(),
    "looped": small_specs.LOOPED.encode(),
    "winding": small_specs.WINDING.encode(),
    "without_link": small_specs.WITHOUT_LINK.encode(),
    "too_short": small_specs.TOO_SHORT.encode(),
    "spatial": SPATIAL.encode(),
    **{f"mission_{name.lower()}": SHOP.encode() for name in MISSIONS},
}
OPTIONS = {
    "beyond_reach": ("--no-lemmas",),
    "too_short": ("--no-lemmas",),
    **{f"mission_{name.lower()}": ("--mission", name) for name in MISSIONS},
}
"""Of those that are made with some."""


# The same few examples every time; `make test-slow` takes more, and looks for others. However busy
# the machine is, no test fails because it is slow.
PATIENT = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile(USUAL, PATIENT, derandomize=True, max_examples=40)
settings.register_profile(OTHERS, PATIENT)
settings.load_profile(USUAL)

# A suite in the background ignores interrupts; the commands that it starts, some of which are
# interrupted, would do the same.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# Until all tests are collected, hardly anything is given back.
gc.disable()


def pytest_collection_finish() -> None:
    """Ten thousand tests and the libraries they load are no garbage to look for again and again."""
    gc.enable()
    gc.collect()
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)


def srgc_process(
    arguments: Sequence[str | Path], folder: Path, **environment: str
) -> subprocess.Popen[bytes]:
    """A ``srgc`` process of its own, in a folder, started but not waited for."""
    return subprocess.Popen(
        [*COMMAND, *map(str, arguments)],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )


def _make(spec: str, folder: Path) -> None:
    """``folder/out`` with the result, and beside it the spec, the exit status and the output."""
    (folder / f"{spec}.srg").write_bytes(SPECS[spec])
    asked = ["synth", f"{spec}.srg", "-o", "out", *OPTIONS.get(spec, ())]
    status = copied(folder, *asked)
    (folder / "status").write_text(str(status), encoding="utf-8")


def _shared(spec: str, base: Path) -> Path:
    """The folder made by whichever worker came first; the others wait for it."""
    done, making = base / f"made-{spec}", base / f"making-{spec}"
    try:
        os.close(os.open(base / f"lock-{spec}", os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        end = time.monotonic() + WAIT_SECONDS
        while not done.exists():
            if time.monotonic() > end:
                pytest.fail(f"the worker that makes {spec} has not finished")
            time.sleep(0.1)
        return done
    making.mkdir()
    try:
        _make(spec, making)
    finally:
        making.rename(done)
    return done


@pytest.fixture(scope="session")
def made(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The folder of a finished ``srgc synth``, read only: NAME.srg out/ status stdout stderr."""
    from tests.long_tests import SHARED  # A plugin, which pytest has to import first.

    base = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        base = base.parent
    known: dict[str, Path] = {}

    def get(spec: str) -> Path:
        if spec not in known:
            with SHARED.making():
                known[spec] = _shared(spec, base)
        claims = [known[spec] / "out" / name for name in ("certificate.json", "mission.json")]
        if not any(claim.exists() for claim in claims):
            pytest.fail(f"no verdict on {spec}: {(known[spec] / 'stderr').read_text()[-2000:]}")
        return known[spec]

    return get


@pytest.fixture
def result(made: Callable[[str], Path], tmp_path: Path) -> Callable[[str], Path]:
    """A fresh copy of the result folder of a spec."""

    def copy(spec: str) -> Path:
        target = tmp_path / f"result-{spec}"
        shutil.copytree(made(spec) / "out", target)
        return target

    return copy


@pytest.fixture
def without_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """For tests that look at no picture: syntheses of this process draw none, which saves time."""
    from srgc.render import result_pictures

    for name in ("workspace_figure", "input_figure"):
        monkeypatch.setattr(result_pictures, name, lambda *_: "<svg/>")
