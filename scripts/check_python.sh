#!/bin/sh
# Says in one line what a fresh machine lacks: Python 3.10 or later, with venv.
set -eu
python=${PYTHON:-python3}

if ! command -v "$python" >/dev/null 2>&1; then
    echo "$python was not found; on Debian and Ubuntu: sudo apt install python3 python3-venv" >&2
    exit 1
fi
if ! "$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))'; then
    echo "$python is $("$python" -V 2>&1), SmartTestudo needs Python 3.10 or later; choose one with: make PYTHON=python3.12" >&2
    exit 1
fi
if ! "$python" -c 'import ensurepip, venv' >/dev/null 2>&1; then
    echo "$python has no venv; on Debian and Ubuntu: sudo apt install python3-venv" >&2
    exit 1
fi
