#!/bin/sh
# Builds the documentation as a site into FOLDER, or without one into the package, for the Ruler's page: with MkDocs from PYTHON's
# environment, or from one made for it.
set -eu
unset PYTHONPATH
python=${PYTHON:-.venv/bin/python}
folder=${1:-src/smarttestudo/ruler/server/documentation}
if ! "$python" -c 'import material, mkdocs' 2>/dev/null; then
    made=$(mktemp -d)
    trap 'rm -rf "$made"' EXIT
    "$python" -m venv "$made"
    "$made/bin/pip" install --quiet --disable-pip-version-check 'mkdocs>=1.6' 'mkdocs-material>=9.6'
    python=$made/bin/python
fi
NO_MKDOCS_2_WARNING=1 "$python" -m mkdocs build --quiet --site-dir "$folder.new"
# Not needed in the package: other languages, the index for pages without a server, sources of scripts, pictures for developers.
if [ $# = 0 ]; then (
    cd "$folder.new"
    rm -rf assets/javascripts/lunr search/search_index.js sitemap.xml sitemap.xml.gz 404.html images/sheets
    find . -name '*.map' -delete
) fi
rm -rf "$folder"
mv "$folder.new" "$folder"
