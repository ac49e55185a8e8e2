"""The motion of a design as NumPy arrays in one file (npz)."""

from __future__ import annotations

import io
import zipfile

import numpy as np
from numpy.typing import NDArray

from srgc.exports.exported_motion import ExportedMotion

EPOCH = (1980, 1, 1, 0, 0, 0)
"""Of every member: the earliest time that zip files know."""
UNIX = 3


def trajectory_arrays(motion: ExportedMotion) -> bytes:
    """The file; same motion, same bytes.  Nothing in it is compressed or pickled."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for name, array in _arrays(motion).items():
            member = zipfile.ZipInfo(f"{name}.npy", EPOCH)
            member.create_system = UNIX
            member.external_attr = 0o644 << 16
            content = io.BytesIO()
            np.lib.format.write_array(content, array, allow_pickle=False)
            archive.writestr(member, content.getvalue())
    return buffer.getvalue()


def _arrays(motion: ExportedMotion) -> dict[str, NDArray[np.generic]]:
    numbers = {
        "t": np.array([float(time) for time in motion.times]),
        "q": motion.position,
        "qd": motion.velocity,
        "qdd": motion.acceleration,
        "effort": motion.effort,
        "u": motion.input,
        "s": motion.state,
        "effectors": motion.effector,
    }
    texts = {
        "joint_names": [joint.name for joint in motion.joints],
        "input_names": [item.name for item in motion.inputs],
        "state_names": [item.name for item in motion.states],
        "effector_names": list(motion.effectors),
        "word": list(motion.design.claim.word),
        "spec_sha256": [motion.design.claim.spec_sha256],
    }
    return {
        **{name: np.ascontiguousarray(value, dtype="<f8") for name, value in numbers.items()},
        **{name: _texts(value) for name, value in texts.items()},
    }


def _texts(values: list[str]) -> NDArray[np.generic]:
    width = max((len(value) for value in values), default=1) or 1
    return np.array(values, dtype=f"<U{width}")
