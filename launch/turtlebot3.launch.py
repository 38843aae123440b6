# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""SmartTestudo beside a TurtleBot3: on the robot, or with ``sim:=true`` in the demo's warehouse in Gazebo.

``ros2 launch smarttestudo turtlebot3.launch.py --show-args`` lists what can be set.
"""

from __future__ import annotations

from launch import LaunchContext, LaunchDescription
from launch.actions import (
    AppendEnvironmentVariable,
    DeclareLaunchArgument,
    GroupAction,
    IncludeLaunchDescription,
    OpaqueFunction,
    SetEnvironmentVariable,
)
from launch.conditions import IfCondition
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import EnvironmentVariable, LaunchConfiguration, PathJoinSubstitution
from launch_ros.substitutions import FindPackageShare

OF_THE_RUN = ("rules", "budget", "namespace", "prefix", "output_domain")


def generate_launch_description() -> LaunchDescription:
    """All arguments, Gazebo or the robot's own nodes where they are asked for, and the runtime."""
    return LaunchDescription([*arguments(), robot(), gazebo(), OpaqueFunction(function=runtime)])


def arguments() -> list[DeclareLaunchArgument]:
    """What can be set on the command line."""
    defaults = {
        "sim": ("false", "start Gazebo with the warehouse and a TurtleBot3 (ROS 2 Jazzy or later)"),
        "bringup": ("false", "start the robot's own nodes too (turtlebot3_bringup)"),
        "rules": (shared("smarttestudo", "examples", "warehouse.adirf"), "rule file, or folder of them"),
        "profile": ("", "what is known about the topics, if not that of a TurtleBot3, real or simulated"),
        "budget": ("", "KB/s that all relayed topics together may take"),
        "namespace": ("", "of the node, and of relative topics in the rules"),
        "prefix": ("", "what to put before every topic of the rules, as in /tb3_0"),
        "output_domain": ("", "ROS domain to relay into, so that the radio carries nothing else"),
    }
    return [
        DeclareLaunchArgument(name, default_value=default, description=meaning)
        for name, (default, meaning) in defaults.items()
    ]


def runtime(context: LaunchContext) -> list[IncludeLaunchDescription]:
    """SmartTestudo, as testudo.launch.py starts it."""
    given = context.launch_configurations
    in_gazebo = IfCondition(LaunchConfiguration("sim")).evaluate(context)
    return [
        include(
            "smarttestudo",
            "testudo.launch.py",
            profile=given["profile"] or usual_profile(in_gazebo=in_gazebo),
            use_sim_time=str(in_gazebo).lower(),
            **{name: given[name] for name in OF_THE_RUN},
        )
    ]


def usual_profile(*, in_gazebo: bool) -> PathJoinSubstitution:
    """What the package knows about the topics of a TurtleBot3."""
    if in_gazebo:
        return shared("smarttestudo", "profiles", "turtlebot3_gazebo.toml")
    return shared("smarttestudo", "profiles", "turtlebot3.toml")


def robot() -> GroupAction:
    """The nodes of a real TurtleBot3."""
    return GroupAction(
        [include("turtlebot3_bringup", "robot.launch.py")],
        condition=IfCondition(LaunchConfiguration("bringup")),
    )


def gazebo() -> GroupAction:
    """The warehouse, and a TurtleBot3 at its origin, so that /odom tells the metres of the rules."""
    model = EnvironmentVariable("TURTLEBOT3_MODEL", default_value="waffle")
    world = shared("smarttestudo", "worlds", "warehouse.sdf")
    return GroupAction(
        [
            SetEnvironmentVariable("TURTLEBOT3_MODEL", model),
            AppendEnvironmentVariable("GZ_SIM_RESOURCE_PATH", shared("turtlebot3_gazebo", "models")),
            include("ros_gz_sim", "gz_sim.launch.py", gz_args=["-r ", world], on_exit_shutdown="true"),
            include("turtlebot3_gazebo", "robot_state_publisher.launch.py", use_sim_time="true"),
            include("turtlebot3_gazebo", "spawn_turtlebot3.launch.py", x_pose="0.0", y_pose="0.0"),
        ],
        condition=IfCondition(LaunchConfiguration("sim")),
    )


def include(package: str, name: str, **given: str | list | PathJoinSubstitution) -> IncludeLaunchDescription:
    """The launch file of another package."""
    source = PythonLaunchDescriptionSource(shared(package, "launch", name))
    return IncludeLaunchDescription(source, launch_arguments=given.items())


def shared(package: str, *path: str) -> PathJoinSubstitution:
    """A file that a package shares; looked for only when it is needed."""
    return PathJoinSubstitution([FindPackageShare(package), *path])
