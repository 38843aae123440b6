# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Who installs from a checkout gets the page where it can be built, and everything else in any case.

A source archive, from which the wheel of a release is built, holds the page or is not made.

Node and MkDocs are stand-ins here: the real ones fetch what they need from the network.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

from installations.environments import copy_checkout

PAGE = "smarttestudo/ruler/server/static/index.html"
DOCUMENTATION = "smarttestudo/ruler/server/documentation/index.html"
MAKE_DOCUMENTATION = f"mkdir -p src/{Path(DOCUMENTATION).parent} && echo text > src/{DOCUMENTATION}\n"
NPM = "#!/bin/sh\ncd ../src/smarttestudo/ruler/server && mkdir -p static && echo page > static/index.html\n"
BROKEN_NPM = "#!/bin/sh\nexit 1\n"


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A copy of the source as it is checked out, without a built page."""
    copy_checkout(tmp_path / "checkout", with_page=False)
    (tmp_path / "checkout" / "scripts" / "make_documentation.sh").write_text(MAKE_DOCUMENTATION)
    return tmp_path / "checkout"


def build(checkout: Path, npm: str, code: str) -> subprocess.CompletedProcess[str]:
    """What setuptools makes there with this npm."""
    programs = checkout.parent / "bin"
    programs.mkdir()
    for name, text in {"node": "#!/bin/sh\necho v22.0.0\n", "npm": npm}.items():
        (programs / name).write_text(text)
        (programs / name).chmod(0o755)
    environment = {**os.environ, "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}"}
    return subprocess.run(
        [sys.executable, "-c", f"from setuptools import build_meta; build_meta.{code}"],
        cwd=checkout,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


def names_in_wheel(checkout: Path, npm: str) -> set[str]:
    done = build(checkout, npm, "build_wheel('dist')")
    assert done.returncode == 0, done.stderr
    (wheel,) = (checkout / "dist").glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        return set(archive.namelist())


def test_a_wheel_built_where_node_is_found_holds_the_page_and_its_documentation(checkout: Path) -> None:
    assert names_in_wheel(checkout, NPM) >= {PAGE, DOCUMENTATION}


def test_a_wheel_is_built_without_documentation_where_that_cannot_be_built(checkout: Path) -> None:
    (checkout / "scripts" / "make_documentation.sh").write_text("exit 1\n")
    names = names_in_wheel(checkout, NPM)
    assert PAGE in names
    assert DOCUMENTATION not in names


def test_a_wheel_is_built_without_the_page_where_that_cannot_be_built(checkout: Path) -> None:
    names = names_in_wheel(checkout, BROKEN_NPM)
    assert not {PAGE, DOCUMENTATION} & names
    assert "smarttestudo/cli/main.py" in names


def test_a_source_archive_holds_the_page(checkout: Path) -> None:
    done = build(checkout, NPM, "build_sdist('dist')")
    assert done.returncode == 0, done.stderr
    (archive,) = (checkout / "dist").glob("*.tar.gz")
    with tarfile.open(archive) as opened:
        names = {name.partition("/")[2] for name in opened.getnames()}
    assert names >= {f"src/{PAGE}", f"src/{DOCUMENTATION}", "gui/package-lock.json", "scripts/make_gui.sh"}


def test_no_source_archive_is_made_without_the_page(checkout: Path) -> None:
    done = build(checkout, BROKEN_NPM, "build_sdist('dist')")
    assert done.returncode == 1
    assert done.stderr.endswith(
        "setup.py: error: a release needs the page of 'testudo ruler'; run 'make gui' first\n"
    )
    assert not list((checkout / "dist").glob("*"))
