#!/bin/bash
# Runs the live tests on an installed ROS 2, in a virtual environment for its Python.
# usage: ROS_SETUP=/opt/ros/humble/setup.bash scripts/test_ros.sh [pytest options]
# ROS_PYTHON is its Python, where uv does not find one of the version that rclpy was built for.
set -eo pipefail
cd "$(dirname "$0")/.."
if [[ ! -r ${ROS_SETUP:-} ]]; then
    echo "error: ROS_SETUP is not the setup file of a ROS 2; ROS_SETUP=/opt/ros/humble/setup.bash" >&2
    exit 2
fi
uv=${UV:-uv}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT INT TERM

# It reads variables that are not set.
source "$ROS_SETUP" ""
set -u
# The folder of rclpy says which Python it was built for: lib/python3.10/site-packages.
version=""
IFS=: read -ra prefixes <<<"$AMENT_PREFIX_PATH"
for rclpy in "${prefixes[@]/%//}"{,local/}lib/python3.*/{site,dist}-packages/rclpy; do
    [[ $rclpy =~ /python(3\.[0-9]+)/ && -d $rclpy ]] && version=${BASH_REMATCH[1]} && break
done
if [[ -z $version ]]; then
    echo "error: no rclpy in $AMENT_PREFIX_PATH" >&2
    exit 2
fi
echo "ROS 2 ${ROS_DISTRO:-of $ROS_SETUP}, Python $version"

# rclpy is found by PYTHONPATH and needs Python packages of the system: PyYAML at least, and NumPy, whose
# version 2 does not run what was built for version 1.
"$uv" venv --quiet --system-site-packages --python "${ROS_PYTHON:-$version}" "$folder/venv"
"$uv" pip install --quiet --python "$folder/venv/bin/python" --editable '.[studio,dev]' pyyaml \
    "numpy<2; python_version < '3.13'"
# Plugins of ROS that pytest would find, such as launch_testing, are for another version of it.
export PYTEST_DISABLE_PLUGIN_AUTOLOAD=1
"$folder/venv/bin/pytest" tests/ros "$@"
