#!/bin/sh
# Builds the Ruler's page from gui/ into the package.
set -eu
sh scripts/gui_npm.sh run build --loglevel=error
