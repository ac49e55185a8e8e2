"""Show a robot in RViz: a launch file and the settings of its window."""

from __future__ import annotations

from srgc.exports.ros.ros_yaml import yaml_text

LAUNCH = '''\
"""Show the robot in RViz, with a slider for each joint: ros2 launch {name} display.launch.py"""

from launch import LaunchDescription
from launch.substitutions import Command, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    share = FindPackageShare("{name}")
    model = PathJoinSubstitution([share, "urdf", "{name}.urdf.xacro"])
    description = ParameterValue(Command(["xacro ", model]), value_type=str)
    window = PathJoinSubstitution([share, "rviz", "display.rviz"])
    return LaunchDescription(
        [
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                parameters=[{{"robot_description": description}}],
            ),
            Node(
                package="joint_state_publisher_gui",
                executable="joint_state_publisher_gui",
            ),
            Node(package="rviz2", executable="rviz2", arguments=["-d", window]),
        ]
    )
'''


def display_launch(name: str) -> str:
    """The launch file of the package with this name."""
    return LAUNCH.format(name=name)


def display_rviz(base: str) -> str:
    """The settings of RViz: a grid, the robot and its frames, relative to the link ``base``."""
    topic = {
        "Depth": 5, "Durability Policy": "Volatile", "History Policy": "Keep Last",
        "Reliability Policy": "Reliable", "Value": "/robot_description",
    }  # fmt: skip
    robot = {
        "Class": "rviz_default_plugins/RobotModel", "Name": "RobotModel", "Enabled": True,
        "Description Source": "Topic", "Description Topic": topic, "Visual Enabled": True,
        "Collision Enabled": False,
    }  # fmt: skip
    manager = {
        "Class": "",
        "Displays": [
            {"Class": "rviz_default_plugins/Grid", "Name": "Grid", "Enabled": True},
            robot,
            {"Class": "rviz_default_plugins/TF", "Name": "TF", "Enabled": False},
        ],
        "Global Options": {"Fixed Frame": base, "Frame Rate": 30},
        "Tools": [{"Class": "rviz_default_plugins/MoveCamera"}],
        "Views": {"Current": {"Class": "rviz_default_plugins/Orbit", "Distance": 3.0}},
    }
    panels = [{"Class": "rviz_common/Displays", "Name": "Displays"}]
    return yaml_text({"Panels": panels, "Visualization Manager": manager})
