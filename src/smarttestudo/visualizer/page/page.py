# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The page as a whole."""

from __future__ import annotations

from html import escape

from smarttestudo.visualizer.page.page_input import PageInput


def render_page(page: PageInput) -> str:
    """One self-contained HTML document."""
    return f"<!doctype html><html lang=en><title>{escape(page.title)}</title></html>"
