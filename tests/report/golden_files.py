# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Outputs that must read as a file in the folder ``golden`` beside their test.

``WRITE_GOLDEN=1 pytest FILES`` writes the files as the outputs are now, and ``git diff`` shows what changed.
"""

from __future__ import annotations

import os
import re
from difflib import unified_diff
from pathlib import Path

import pytest

from smarttestudo import __version__

_UNREAD = re.compile(r"<(script|style)\b.*?</\1>|(?<= content=\")default-src[^\"]*", re.DOTALL)
_ELEMENT = re.compile(r"<(?!/|wbr|span|td|th\b)")


def assert_reads_as(golden: Path, text: str) -> None:
    """``text`` is what the file says, to the last character."""
    if "WRITE_GOLDEN" in os.environ:
        golden.write_text(text, encoding="utf-8")
    expected = golden.read_text(encoding="utf-8")
    if text != expected:
        diff = unified_diff(expected.splitlines(), text.splitlines(), str(golden), "shown", lineterm="")
        pytest.fail("\n".join(diff), pytrace=False)


def page_lines(html: str) -> str:
    """A page without scripts, styles and the version of SmartTestudo, one line for each of its elements."""
    shown = _UNREAD.sub("", html).replace(f">{__version__}<", ">VERSION<")
    return _ELEMENT.sub("\n<", shown).lstrip("\n")
