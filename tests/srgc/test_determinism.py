"""Same input, same seed: same bytes, whatever the hash seed and the number of processes."""

from __future__ import annotations

import pytest

from tests.conftest import OPTIONS, srgc_process
from tests.oracles.some_cases import some


# The results compared with were made with the hash seed 1 and one process.
def check(made, tmp_path, spec, hash_seed, jobs):
    place = made(spec)
    (tmp_path / f"{spec}.srg").write_bytes((place / f"{spec}.srg").read_bytes())
    arguments = ["synth", f"{spec}.srg", "-o", "out", "--jobs", jobs, *OPTIONS.get(spec, ())]
    with srgc_process(arguments, tmp_path, PYTHONHASHSEED=hash_seed) as process:
        _, err = process.communicate(timeout=900)
    assert process.returncode == int((place / "status").read_text()), err
    for name in ("design.json", "certificate.json"):
        assert (tmp_path / "out" / name).read_bytes() == (place / "out" / name).read_bytes()


@pytest.mark.parametrize("spec", some(["turner", "beyond_reach"], 1))
def test_a_small_spec(made, tmp_path, spec):
    check(made, tmp_path, spec, hash_seed="2", jobs="2")


@pytest.mark.slow
@pytest.mark.parametrize("spec", ["planar_arm", "robust_arm", "patrol"])
def test_a_shipped_spec(made, tmp_path, spec):
    """First proofs go on beside the search."""
    check(made, tmp_path, spec, hash_seed="2", jobs="2")
