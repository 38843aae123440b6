# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""SmartTestudo beside any robot.

``ros2 launch smarttestudo testudo.launch.py --show-args`` lists what can be set.
"""

from __future__ import annotations

import shlex

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

OPTIONS = {
    "rules": "--rules",
    "profile": "--profile",
    "budget": "--budget",
    "link": "--link",
    "incidents": "--incidents",
    "decisions": "--decisions",
    "prefix": "--topic-prefix",
    "output_domain": "--output-domain",
}
ARGUMENTS = {
    "rules": "rule file, or folder of them",
    "profile": "what is known about the topics (TOML)",
    "budget": "KB/s that all relayed topics together may take",
    "link": "where 'testudo receive' listens, as in tls/192.168.1.5:7447",
    "incidents": "folder to write what the rules record into",
    "decisions": "file to append the decisions to (JSON Lines)",
    "namespace": "of the node, and of relative topics in the rules",
    "prefix": "what to put before every topic of the rules, as in /tb3_0",
    "output_domain": "ROS domain to relay into, so that the radio carries nothing else",
    "arguments": "more options of 'testudo run', as on a command line",
}


def generate_launch_description() -> LaunchDescription:
    """The arguments, which may all be left out, and the node."""
    return LaunchDescription(
        [
            *(
                DeclareLaunchArgument(name, default_value="", description=meaning)
                for name, meaning in ARGUMENTS.items()
            ),
            DeclareLaunchArgument("use_sim_time", default_value="false", description="follow /clock"),
            OpaqueFunction(function=node),
        ]
    )


def node(context: LaunchContext) -> list[Node]:
    """SmartTestudo, with the arguments that are not empty."""
    given = context.launch_configurations
    options = [word for name, option in OPTIONS.items() if given[name] for word in (option, given[name])]
    return [
        Node(
            package="smarttestudo",
            executable="smart_testudo",
            namespace=given["namespace"],
            arguments=[*options, *shlex.split(given["arguments"])],
            parameters=[{"use_sim_time": LaunchConfiguration("use_sim_time")}],
            output="screen",
        )
    ]
