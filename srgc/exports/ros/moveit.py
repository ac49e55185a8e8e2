"""Write the files that MoveIt and its controllers need beyond an SRDF (moveit.picknik.ai)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from srgc.exports.exported_robot import ExportedRobot, Motor
from srgc.exports.joint_file import moveit_limits
from srgc.exports.ros.ros_yaml import yaml_text
from srgc.exports.ros.srdf import PlanningGroup, srdf_text

KDL = "kdl_kinematics_plugin/KDLKinematicsPlugin"
TRAJECTORIES = "joint_trajectory_controller/JointTrajectoryController"
STATES = "joint_state_broadcaster/JointStateBroadcaster"
MANAGER = "moveit_simple_controller_manager/MoveItSimpleControllerManager"
CONTROLLER = "arm_controller"
UPDATE_RATE = 100


def moveit_files(
    name: str, robot: ExportedRobot, groups: tuple[PlanningGroup, ...]
) -> dict[str, str]:
    """The configuration files of MoveIt by their names."""
    return {
        f"config/{name}.srdf": srdf_text(robot, groups),
        "config/joint_limits.yaml": yaml_text(_limits(robot)),
        "config/kinematics.yaml": yaml_text({group.name: _solver() for group in groups}),
        "config/moveit_controllers.yaml": yaml_text(_moveit_controllers(robot)),
        "config/ros2_controllers.yaml": yaml_text(_controllers(robot)),
    }


def _limits(robot: ExportedRobot) -> Mapping[str, Any]:
    """The robot's limits; if it has none, the file states that, and MoveIt assumes its own."""
    return {
        "default_velocity_scaling_factor": 1.0,
        "default_acceleration_scaling_factor": 1.0,
        "joint_limits": {motor.name: _limit(motor) for motor in robot.motors()},
    }


def _limit(motor: Motor) -> dict[str, Any]:
    found: dict[str, Any] = {"has_position_limits": motor.joint.range is not None}
    if motor.joint.range is not None:
        found |= dict(zip(("min_position", "max_position"), motor.joint.range, strict=True))
    found |= dict(moveit_limits(motor))
    found["has_effort_limits"] = motor.bound is not None
    if motor.bound is not None:
        found["max_effort"] = motor.bound
    return found


def _solver() -> dict[str, Any]:
    return {
        "kinematics_solver": KDL,
        "kinematics_solver_search_resolution": 0.005,
        "kinematics_solver_timeout": 0.05,
    }


def _moveit_controllers(robot: ExportedRobot) -> Mapping[str, Any]:
    names = [motor.name for motor in robot.motors()]
    controller = {
        "type": "FollowJointTrajectory",
        "action_ns": "follow_joint_trajectory",
        "default": True,
        "joints": names,
    }
    return {
        "moveit_controller_manager": MANAGER,
        "moveit_simple_controller_manager": {
            "controller_names": [CONTROLLER],
            CONTROLLER: controller,
        },
    }


def _controllers(robot: ExportedRobot) -> Mapping[str, Any]:
    names = [motor.name for motor in robot.motors()]
    return {
        "controller_manager": {
            "ros__parameters": {
                "update_rate": UPDATE_RATE,
                CONTROLLER: {"type": TRAJECTORIES},
                "joint_state_broadcaster": {"type": STATES},
            }
        },
        CONTROLLER: {
            "ros__parameters": {
                "joints": names,
                "command_interfaces": ["position"],
                "state_interfaces": ["position", "velocity"],
            }
        },
    }
