# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A hook of MkDocs: documents at the root are pages, too, and searches find users' pages."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page
from mkdocs.utils import get_relative_url

FOLDER = "contributors"
PAGES: Mapping[str, str] = {
    "ARCHITECTURE.md": f"{FOLDER}/architecture.md",
    "CONTRIBUTING.md": f"{FOLDER}/contributing.md",
    "CHANGELOG.md": f"{FOLDER}/changelog.md",
    "SECURITY.md": f"{FOLDER}/security.md",
}
"""Pages of the site by the document at the root of the repository."""
_BOOSTS = {"How-to": 2, "Concepts": 2, "Reference": 0.7, "Troubleshooting": 3, "The language": 3}
"""What a hit in a part of the menu or a page counts, beside 1; what is named last here counts."""
_CORNER = "Contributors' corner"
_FOLDERS = {"docs/decisions": "decisions/0001-deadline-grid-with-capped-credit.md"}
_SCRIPT = re.compile(r"<script>(.+?)</script>", re.DOTALL)
_LINK = re.compile(r"\]\((?![a-z]+:|#)([^)#\s]+)(#[^)\s]*)?\)")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages."""
    root = Path(config.config_file_path).parent
    for name, page in PAGES.items():
        text = (root / name).read_text(encoding="utf-8")
        files.append(File.generated(config, page, content=_LINK.sub(_link_on_site, text)))
    return files


def on_page_markdown(markdown: str, page: Page, **_: object) -> str:
    """Have searches find users' pages, by where they are in the menu."""
    places = {str(page.title), *(str(one.title) for one in page.ancestors)}
    boosts = [boost for place, boost in _BOOSTS.items() if place in places]
    page.meta["search"] = {"exclude": True} if _CORNER in places else {"boost": (boosts or [1])[-1]}
    return markdown


def on_post_page(output: str, page: Page, config: MkDocsConfig) -> str:
    """Have scripts within the page in files, which alone the policy of the Ruler's server lets run."""

    def moved(script: re.Match[str]) -> str:
        name = f"assets/javascripts/page.{hashlib.sha256(script[1].encode()).hexdigest()[:8]}.js"
        path = Path(config.site_dir, name)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(script[1], encoding="utf-8")
        return f'<script src="{get_relative_url(name, page.url)}"></script>'

    return _SCRIPT.sub(moved, output)


def on_post_build(config: MkDocsConfig) -> None:
    """Have the search take options and pasted errors as words."""
    before = Path(__file__).with_name("site_search.js").read_text(encoding="utf-8")
    for worker in Path(config.site_dir, "assets", "javascripts", "workers").glob("search.*.js"):
        worker.write_text(before + worker.read_text(encoding="utf-8"), encoding="utf-8")


def _link_on_site(link: re.Match[str]) -> str:
    """A link at the root of the repository as one of a page in the folder of contributors."""
    target = link[1].rstrip("/")
    page = PAGES.get(target) or _FOLDERS.get(target) or target.removeprefix("docs/")
    return f"](../{page}{link[2] or ''})"
