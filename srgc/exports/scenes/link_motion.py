"""Compute the poses of a robot's links and effectors from the coordinates of its joints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from compiler.rigid_links.ball_pose import Pose, doubles, nearest
from compiler.rigid_links.rigid_tree import LinkJoint, RigidTree


@dataclass(frozen=True, slots=True, eq=False)
class Poses:
    """Poses of frames in the world or in other frames.

    Attributes:
        turns: (..., 3, 3) rotations, whose columns are the axes of the frames.
        origins: (..., 3) in metres.
    """

    turns: Array
    origins: Array

    def __matmul__(self, inner: Poses) -> Poses:
        """Compose poses: ``inner`` is given in these frames, the result where these are given."""
        origins = self.origins + (self.turns @ inner.origins[..., None])[..., 0]
        return Poses(self.turns @ inner.turns, origins)

    def points(self, local: Array) -> Array:
        """Points (m, 3) given in each frame, transformed to shape (..., m, 3)."""
        found: Array = self.origins[..., None, :] + local @ np.swapaxes(self.turns, -1, -2)
        return found

    def quaternions(self) -> Array:
        """Unit quaternions (w, x, y, z) with shape (..., 4) and w >= 0."""
        from scipy.spatial.transform import Rotation

        flat = Rotation.from_matrix(self.turns.reshape(-1, 3, 3)).as_quat(canonical=True)
        found: Array = flat[:, [3, 0, 1, 2]].reshape(*self.turns.shape[:-2], 4)
        return found + 0.0


@dataclass(frozen=True, slots=True, eq=False)
class LinkMotion:
    """Poses in the world at K instants: of links (K, L) and of effectors (K, e).

    ``joints`` are the poses (K, L) of links in the links that carry them, and of the base in the
    world.
    """

    links: Poses
    effectors: Poses
    joints: Poses


def link_motion(tree: RigidTree, q: Array) -> LinkMotion:
    """The motion of a tree with joint coordinates q (K, n) in rad or m."""
    links = list[Poses]()
    joints = list[Poses]()
    for link in tree.links:
        if link.joint is None:
            still = np.broadcast_to(np.eye(3), (len(q), 3, 3)), np.zeros((len(q), 3))
            joints.append(Poses(*still))
            links.append(joints[-1])
        else:
            joints.append(plain_pose(link.joint.origin) @ _moved(link.joint, q[:, link.joint.dof]))
            links.append(links[link.joint.parent] @ joints[-1])
    effectors = [links[frame.link] @ plain_pose(frame.pose) for frame in tree.effectors]
    return LinkMotion(
        _stacked(links, len(q)), _stacked(effectors, len(q)), _stacked(joints, len(q))
    )


def plain_pose(pose: Pose) -> Poses:
    """A single pose in doubles."""
    turn = [[nearest(pose.rotation[i, j]) for j in range(3)] for i in range(3)]
    return Poses(np.array(turn), np.array(doubles(pose.origin)))


def _moved(joint: LinkJoint, values: Array) -> Poses:
    """The motion of a joint about or along an axis of its own frame, at values (K,)."""
    count, axis = len(values), joint.axis
    turns = np.tile(np.eye(3), (count, 1, 1))
    origins = np.zeros((count, 3))
    if joint.kind == "prismatic":
        origins[:, axis] = joint.sign * values
        return Poses(turns, origins)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    cosine, sine = np.cos(values), joint.sign * np.sin(values)
    turns[:, i, i] = turns[:, j, j] = cosine
    turns[:, i, j], turns[:, j, i] = -sine, sine
    return Poses(turns, origins)


def _stacked(each: list[Poses], count: int) -> Poses:
    if not each:
        return Poses(np.zeros((count, 0, 3, 3)), np.zeros((count, 0, 3)))
    turns = np.stack([pose.turns for pose in each], axis=1)
    return Poses(turns, np.stack([pose.origins for pose in each], axis=1))
