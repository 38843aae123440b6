#!/bin/sh
# Shows that the robot's and the laptop's installs resolve to binary wheels on 64-bit ARM; nothing is run there.
set -eu
uv=${UV:-uv}

for version in 3.10 3.12; do
    for extra in "" link studio physics; do
        echo "aarch64, Python $version, ${extra:-robot (no extra)}:"
        "$uv" pip compile --quiet --no-header --no-annotate pyproject.toml ${extra:+--extra "$extra"} \
            --only-binary :all: --python-platform aarch64-manylinux_2_28 --python-version "$version" |
            sed 's/^/    /'
    done
done
