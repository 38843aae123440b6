#!/bin/sh
# Tags this commit as the release of its version, with the changes of that as the tag's text. Nothing is pushed.
# A maintainer's address that nobody has is asked for, or taken from MAINTAINER, and committed before.
# The tag is signed where git has a key (user.signingkey).
set -eu
python=${PYTHON:-.venv/bin/python}
root=$(git rev-parse --show-toplevel)
cd "$root"
files() { "$python" "$(dirname "$script")/release_files.py" --root "$root" "$@"; }
script=$(realpath "$0")
refuse() { echo "error: $1" >&2; exit 1; }

[ -z "$(git status --porcelain --untracked-files=no)" ] || refuse "there are changes that are not committed; commit them, then tag"
files --check
version=$(sed -n 's/^__version__ = "\(.*\)"$/\1/p' src/smarttestudo/__init__.py)
tag=v$version
! git rev-parse --quiet --verify "refs/tags/$tag" >/dev/null || refuse "$tag is there already; raise __version__ in src/smarttestudo/__init__.py"

address=$(sed -n 's/.*<maintainer email="\([^"]*\)".*/\1/p' package.xml)
case $address in
    *.invalid)
        maintainer=${MAINTAINER:-}
        if [ -z "$maintainer" ] && [ -t 0 ]; then
            printf "The maintainer's address for package.xml, in place of %s: " "$address" >&2
            read -r maintainer
        fi
        [ -n "$maintainer" ] || refuse "package.xml has no maintainer's address; MAINTAINER=name@example.org $0"
        case $maintainer in *.invalid) refuse "$maintainer: nobody can have this address" ;; esac
        files --maintainer "$maintainer" >/dev/null
        git commit --quiet --message "Name the maintainer's address for the release $version" package.xml
        ;;
esac

sign=--annotate
if git config user.signingkey >/dev/null; then sign=--sign; fi
# Its headings begin with the character that git takes for a comment.
{ echo "SmartTestudo $version"; echo; files --notes; } | git tag "$sign" --cleanup=whitespace --file=- "$tag"
echo "$tag: push it with: git push origin HEAD $tag"
