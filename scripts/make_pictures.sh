#!/bin/sh
# Redraws the report and the pictures of the Ruler in docs/images, with Debian's Chromium and no network.
set -eu
testudo=${TESTUDO:-.venv/bin/testudo}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT INT TERM

"$testudo" demo --out "$folder/demo-out" >/dev/null
mkdir -p docs/images
chromium --headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking \
    --user-data-dir="$folder/chromium" --hide-scrollbars --window-size=1280,1640 \
    --screenshot=docs/images/demo-report.png "file://$folder/demo-out/report.html" >/dev/null 2>&1
# Without its bar of buttons, which is at the bottom of the window, and the tables above that.
"${PYTHON:-.venv/bin/python}" -c 'from PIL import Image; path = "docs/images/demo-report.png"
image = Image.open(path); image.load(); image.crop((0, 0, 1280, 1205)).save(path, optimize=True)'
"${PYTHON:-.venv/bin/python}" scripts/make_ruler_pictures.py
