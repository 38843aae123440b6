#!/bin/sh
# Makes what a release uploads from what git tracks here, and tries it in an empty environment.
# The source archive and the wheel are put into dist/, or into DIST.
set -eu
python=$(realpath -s "${PYTHON:-.venv/bin/python}")
uv=$(dirname "$python")/uv
dist=$(realpath -m "${DIST:-dist}")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT INT TERM

version=$(sed -n 's/^__version__ = "\(.*\)"$/\1/p' src/smarttestudo/__init__.py)
says() { grep -qF "$2" "$1" || { echo "$1: error: it does not say $2, the version of src/smarttestudo/__init__.py" >&2; exit 1; }; }
says package.xml "<version>$version</version>"
says CITATION.cff "version: $version"
says CHANGELOG.md "## [$version]"

mkdir "$folder/source"
git ls-files -z | xargs -0 cp --parents --target-directory="$folder/source"
(cd "$folder/source" && PYTHON=$python "$python" -m build --outdir "$folder/dist" . >"$folder/build.log" 2>&1) || {
    tail -n 20 "$folder/build.log" >&2
    exit 1
}

wheel=$(echo "$folder"/dist/*.whl)
"$uv" venv --quiet --python "$python" "$folder/empty"
"$uv" pip install --quiet --python "$folder/empty/bin/python" "$wheel[studio]"
(cd "$folder" && "$folder/empty/bin/testudo" demo --seconds 2 --out "$folder/demo-out" >"$folder/demo.log" 2>&1) || {
    tail -n 5 "$folder/demo.log" >&2
    exit 1
}
"$folder/empty/bin/python" -c 'import sys; from smarttestudo.web.page import is_page_built; sys.exit(not is_page_built())' || {
    echo "$wheel: error: it lacks the page of 'testudo ruler'" >&2
    exit 1
}

mkdir -p "$dist"
cp "$folder"/dist/* "$dist"
for made in "$folder"/dist/*; do echo "$dist/$(basename "$made")"; done
