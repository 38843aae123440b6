# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The Ruler's server as the page sees it."""

from __future__ import annotations

from pathlib import Path

from starlette.testclient import TestClient

from smarttestudo.adapters.files.project_folder import ProjectFolder
from smarttestudo.web.app import ruler_app
from smarttestudo.web.guard import Access

ORIGIN = "http://127.0.0.1:8750"
EXAMPLES = Path(__file__).parents[2] / "examples"


def client_of(folder: Path, *, opened: str | None = None, access: Access | None = None) -> TestClient:
    """A browser's view of the server of ``folder``."""
    access = access or Access.at("127.0.0.1", 8750)
    app = ruler_app(ProjectFolder(folder), access, opened=opened)
    return TestClient(app, base_url=ORIGIN, headers={"Origin": ORIGIN})
