#!/bin/sh
# Runs all tests in three parts: those on no ROS graph, the live ones, and those of the live ones that judge rates
# and have the machine for themselves. More workers than processors, for the tests wait much; a live one waits most.
# usage: BIN=.venv/bin scripts/run_tests.sh [pytest options]
set -u
bin=${BIN:-.venv/bin}
results=build/tests
live="tests/ros tests/ruler/browser/test_robot.py"
processors=$(getconf _NPROCESSORS_ONLN)
failed=""

part() {
    name=$1
    shift
    echo "Tests, $name"
    "$bin/pytest" --quiet --junitxml "$results/$name.xml" "$@" || failed="$failed $name"
}

parallel() {
    echo "--numprocesses $1 --dist worksteal"
}

rm -rf "$results"
mkdir -p "$results"
ignored=""
for path in $live; do ignored="$ignored --ignore $path"; done
# shellcheck disable=SC2046,SC2086
part first $(parallel $((processors * 3 / 2))) tests $ignored "$@"
if [ -z "$failed" ]; then
    workers=$((processors * 2))
    # shellcheck disable=SC2046,SC2086
    part live $(parallel $((workers < 8 ? workers : 8))) -m "not calm" $live "$@"
    # shellcheck disable=SC2086
    part calm -m calm $live "$@"
fi
"$bin/python" scripts/slowest_tests.py "$results"/*.xml
case $failed in
    "") exit 0 ;;
    " first") echo "The first part failed, so the live tests did not run: $bin/pytest $live" >&2 ;;
    *) echo "Failed:$failed" >&2 ;;
esac
exit 1
