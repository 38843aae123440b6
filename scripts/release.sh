#!/bin/sh
# Makes what a release uploads from what git tracks here, and tries it in an empty environment.
# The source archive and the wheel are put into dist/, or into DIST.
# usage: scripts/release.sh [--tag]      with --tag, scripts/tag_release.sh tags the commit at the end
set -eu
python=$(realpath -s "${PYTHON:-.venv/bin/python}")
uv=$(dirname "$python")/uv
dist=$(realpath -m "${DIST:-dist}")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT INT TERM

"$python" scripts/release_files.py --check

# The wheel is for every machine; relays are compiled where it is installed from source.
export SMARTTESTUDO_WITHOUT_RELAYS=1
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
"$folder/empty/bin/python" -c 'import sys; from smarttestudo.ruler.server.page import is_page_built; sys.exit(not is_page_built())' || {
    echo "$wheel: error: it lacks the page of 'testudo ruler'" >&2
    exit 1
}

mkdir -p "$dist"
cp "$folder"/dist/* "$dist"
for made in "$folder"/dist/*; do echo "$dist/$(basename "$made")"; done
if [ "${1:-}" = --tag ]; then PYTHON=$python sh scripts/tag_release.sh; fi
