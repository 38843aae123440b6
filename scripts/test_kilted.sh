#!/bin/sh
# Runs the live tests on ROS 2 Kilted, in an environment of its own in build/kilted.
# usage: scripts/test_kilted.sh promises|live|calm [pytest options]
# `live` makes the environment and runs what other work beside it does not disturb, `promises` of that what keeps a
# promise of a document or a port, `calm` the rest. The documents are followed on one distribution only.
set -eu
python=${PYTHON:-.venv/bin/python}
uv=${UV:-.venv/bin/uv}
part=$1
shift
bin=build/kilted/bin

if [ "$part" = calm ]; then
    exec "$bin/pytest" -m calm tests/ros "$@"
fi
[ "$part" = live ] || set -- --tiers contract "$@"
"$uv" venv --quiet --clear --python "$python" build/kilted
"$uv" pip install --quiet --compile-bytecode --python "$bin/python" --editable '.[studio,dev,physics]' \
    'ros-rclpy[fastrtps]==9.1.2' ros-diagnostic-msgs==5.5.1 ros-geometry-msgs==5.5.1 ros-nav-msgs==5.5.1 \
    ros-sensor-msgs==5.5.1 ros-std-srvs==5.5.1 ros-test-msgs==2.3.0
exec "$bin/pytest" --numprocesses 2 --dist worksteal -m "not calm" \
    --ignore tests/ros/test_documented_commands.py tests/ros "$@"
