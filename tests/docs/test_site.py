# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The documentation is also a site: whole, without a broken link, and without a request to another host."""

from __future__ import annotations

import os
import re
import runpy
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from ruamel.yaml import YAML

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
FROM_THE_ROOT = set(runpy.run_path(str(ROOT / "scripts" / "site_hooks.py"))["PAGES"].values())
"""Pages that the build makes of documents at the root."""
LOADED = re.compile(r'<(?:script|img|iframe|link)\b[^>]*?(?:src|href)="(https?://[^"]*)"')


def build(config: Path, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--config-file", config, "--site-dir", folder],
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"}, capture_output=True, encoding="utf-8", check=False,
    )  # fmt: skip


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    done = build(ROOT / "mkdocs.yml", folder)
    assert done.returncode == 0, done.stderr
    return folder


def pages_of(menu: object) -> Iterator[str]:
    """The pages that a part of the menu names."""
    if isinstance(menu, str):
        yield menu
    elif isinstance(menu, dict):
        for part in menu.values():
            yield from pages_of(part)
    elif isinstance(menu, list):
        for part in menu:
            yield from pages_of(part)


def test_the_site_has_every_document_and_no_broken_link(site: Path) -> None:
    made = {path.relative_to(site).with_suffix(".md") for path in site.rglob("*.html")} - {Path("404.md")}
    assert made == {path.relative_to(DOCS) for path in DOCS.rglob("*.md")} | set(map(Path, FROM_THE_ROOT))


def test_every_document_is_in_the_menu_once() -> None:
    menu = YAML(typ="safe").load(ROOT / "mkdocs.yml")["nav"]
    pages = {str(path.relative_to(DOCS)) for path in DOCS.rglob("*.md")} | FROM_THE_ROOT
    assert sorted(pages_of(menu)) == sorted(pages)


def test_the_site_loads_nothing_from_another_host(site: Path) -> None:
    loaded = {
        address
        for page in site.rglob("*.html")
        for address in LOADED.findall(page.read_text(encoding="utf-8"))
    }
    assert loaded == set()


def test_a_broken_link_fails_the_build(tmp_path: Path) -> None:
    text = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    config = tmp_path / "mkdocs.yml"
    text = re.sub(r"^hooks:.*\n", "", text, flags=re.MULTILINE)
    config.write_text(re.sub(r"^nav:\n.*", "", text, flags=re.MULTILINE | re.DOTALL), encoding="utf-8")
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "index.md").write_text("# Start\n\n[gone](gone.md)\n", encoding="utf-8")
    done = build(config, tmp_path / "site")
    assert done.returncode != 0
    assert "gone.md" in done.stderr


def test_the_site_is_made_without_the_tools_of_developers(tmp_path: Path) -> None:
    command = ["make", "--dry-run", "docs-site", f"VENV={tmp_path / 'venv'}"]
    said = subprocess.run(command, cwd=ROOT, capture_output=True, encoding="utf-8", check=True).stdout

    assert "make_documentation.sh build/site" in said
    assert "pip" not in said
