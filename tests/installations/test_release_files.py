# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What follows from the version and the changelog, and the tag of a release."""

from __future__ import annotations

import os
import re
import runpy
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from catkin_pkg.changelog import get_changelog_from_path
from catkin_pkg.package import parse_package
from docutils import nodes
from docutils.core import publish_doctree

from installations.environments import ROOT
from smarttestudo import __version__

NAMES = ("CHANGELOG.md", "CHANGELOG.rst", "CITATION.cff", "package.xml", "src/smarttestudo/__init__.py")
TAG = f"v{__version__}"
Tag = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A repository with one commit: the files that a release is made from."""
    for name in NAMES:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    package = tmp_path / "package.xml"
    package.write_text(
        package.read_text(encoding="utf-8").replace(maintainer(ROOT), "authors@smarttestudo.invalid"),
        encoding="utf-8",
    )
    git(tmp_path, "init", "--quiet")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "--quiet", "--message", "All that is there")
    return tmp_path


def maintainer(checkout: Path) -> str:
    (one,) = parse_package(str(checkout / "package.xml")).maintainers
    return str(one.email)


def git(folder: Path, *arguments: str) -> str:
    """What git prints, as somebody who has no key and no settings."""
    settings = ("-c", "user.name=A", "-c", "user.email=a@example.org")
    command = ["git", *settings, *arguments]
    done = subprocess.run(command, cwd=folder, env=environment(), capture_output=True, text=True, check=True)
    return done.stdout


def environment(**variables: str) -> dict[str, str]:
    nobody = {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_SYSTEM": os.devnull}
    people = {
        f"GIT_{who}_{what}": value
        for who in ("AUTHOR", "COMMITTER")
        for what, value in (("NAME", "A"), ("EMAIL", "a@example.org"))
    }
    return {**os.environ, **nobody, **people, "PYTHON": sys.executable, **variables}


def tag(checkout: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["sh", str(ROOT / "scripts" / "tag_release.sh")],
        cwd=checkout,
        env=environment(**variables),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )


def test_what_repeats_the_version_is_what_make_docs_writes() -> None:
    command = [sys.executable, str(ROOT / "scripts" / "release_files.py"), "--check"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_ros_reads_the_changelog_and_the_package() -> None:
    changelog = get_changelog_from_path(str(ROOT / "CHANGELOG.rst"), "smarttestudo")
    versions = [version for version, _, _ in changelog.foreach_version()]
    assert __version__ in versions
    assert parse_package(str(ROOT / "package.xml")).version == __version__


def entries_of(rst: str) -> list[str]:
    """The entries below themes as docutils reads them; any complaint of it is an error."""
    document = publish_doctree(rst, settings_overrides={"halt_level": 1, "report_level": 1})
    items = document.findall(nodes.list_item)
    return [item.astext() for item in items if isinstance(item.parent.parent, nodes.list_item)]


def test_docutils_reads_each_entry_of_the_changelog_as_one() -> None:
    markdown = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    entries = entries_of((ROOT / "CHANGELOG.rst").read_text(encoding="utf-8"))
    assert len(entries) == len(re.findall(r"^- ", markdown, flags=re.MULTILINE))


@pytest.mark.parametrize(
    ("written", "read"),
    [
        ("a line\n  that is wrapped\n  twice", "a line that is wrapped twice"),
        ("wrapped at a sign\n- of a list is another entry", "wrapped at a sign"),
        ("`--budget N`: *Save as* and **never**", "--budget N: Save as and never"),
        ("two `Topic`s, x`y`", "two Topics, xy"),
        ("``a `tick` in code``", "a `tick` in code"),
        ("[a page](docs/a_b.md) and [`code`](x.md)s", "a page and codes"),
        ("a_b, a_ and /tf_static_, 3 * 4 * 5", "a_b, a_ and /tf_static_, 3 * 4 * 5"),
        ("C:\\path, a | b |c|, one ` tick", "C:\\path, a | b |c|, one ` tick"),
        ("#hash, .. note:: and http://example.org/a_", "#hash, .. note:: and http://example.org/a_"),
    ],
)
def test_an_entry_of_any_markdown_is_one_of_the_changelog_for_ros(written: str, read: str) -> None:
    rst = runpy.run_path(str(ROOT / "scripts" / "release_files.py"))["rst"]
    text = f"# Changelog\n\n## 1.2.3 - 2026-01-01\n\nWords above.\n\n### Added\n- {written}\n- last\n"

    first, *_, last = entries_of(rst(text))

    assert (first, last) == (read, "last")


def test_a_tag_has_the_changes_of_its_version_and_a_maintainer_who_can_be_reached(checkout: Path) -> None:
    refused = tag(checkout)
    assert refused.returncode == 1
    assert refused.stderr.startswith("error: package.xml has no maintainer's address; MAINTAINER=name@")
    assert git(checkout, "tag", "--list") == ""

    assert tag(checkout, MAINTAINER="ada@example.org").returncode == 0
    assert maintainer(checkout) == "ada@example.org"
    assert git(checkout, "status", "--porcelain") == ""
    text = git(checkout, "for-each-ref", "--format=%(contents)", f"refs/tags/{TAG}")
    assert text.startswith(f"SmartTestudo {__version__}\n\n")
    assert "\n### Rules\n- ADIRF" in text
    assert "## 0." not in text.replace("### ", "")

    again = tag(checkout)
    assert (again.returncode, again.stderr.partition(";")[0]) == (1, f"error: {TAG} is there already")


@pytest.mark.parametrize(
    ("address", "said"),
    [
        ("ada", "ada: error: it is no address; write it as in name@example.org"),
        ('a"b@example.org', "it is no address"),
        ("ada@smarttestudo.invalid", "nobody can have this address"),
    ],
)
def test_what_is_no_address_is_refused(checkout: Path, address: str, said: str) -> None:
    done = tag(checkout, MAINTAINER=address)
    assert done.returncode != 0
    assert said in done.stderr
    assert git(checkout, "tag", "--list") == ""
    assert git(checkout, "status", "--porcelain") == ""


def test_a_change_that_is_not_committed_and_a_stale_file_are_refused(checkout: Path) -> None:
    (checkout / "CHANGELOG.md").write_text("# Changelog\n\n## Unreleased\n", encoding="utf-8")
    assert "not committed" in tag(checkout).stderr
    git(checkout, "commit", "--quiet", "--all", "--message", "No release")
    done = tag(checkout)
    assert done.returncode == 1
    assert done.stderr.startswith("CHANGELOG.md: error: nothing is like ")
