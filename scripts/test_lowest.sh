#!/bin/sh
# Runs the tests with the lowest allowed version of every direct dependency, in an environment of its own.
set -eu
python=${PYTHON:-python3.10}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT INT TERM

PYTHON=$python sh "$(dirname "$0")/check_python.sh"
"$python" -m venv "$folder/venv"
bin=$folder/venv/bin
"$bin/pip" install --quiet uv
"$bin/uv" pip compile --quiet pyproject.toml --extra studio --extra ros --extra full --resolution lowest-direct \
    --python "$bin/python" --output-file "$folder/lowest.txt"
"$bin/pip" install --quiet --requirement "$folder/lowest.txt"
"$bin/pip" install --quiet --no-deps --editable .
"$bin/python" --version
grep -v '^ *#' "$folder/lowest.txt"
"$bin/pytest" tests "$@"
