#!/bin/sh
# Runs the live tests on ROS 2 Kilted, in an environment of its own.
set -eu
python=${PYTHON:-python3}
uv=${UV:-uv}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT INT TERM

"$uv" venv --quiet --python "$python" "$folder/venv"
"$uv" pip install --quiet --python "$folder/venv/bin/python" --editable '.[studio,dev]' \
    'ros-rclpy[fastrtps]==9.1.2' ros-diagnostic-msgs==5.5.1 ros-geometry-msgs==5.5.1 ros-nav-msgs==5.5.1 \
    ros-sensor-msgs==5.5.1 ros-std-srvs==5.5.1
"$folder/venv/bin/pytest" tests/ros "$@"
