# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Profiles of usual robots and sensors, to begin with until one's own topics are measured."""

from __future__ import annotations

from itertools import takewhile
from pathlib import Path

from msgspec import Struct

from smarttestudo import rules
from smarttestudo.ruler.job import job

_FOLDER = Path(rules.__file__).parent / "presets"


class Preset(Struct, frozen=True, kw_only=True):
    """A profile, its title, and what it describes with the source of its numbers."""

    title: str
    about: str
    text: str


class Presets(Struct, frozen=True, kw_only=True):
    """All presets, by title."""

    presets: tuple[Preset, ...]


@job("GET /api/profile/presets")
def all_presets() -> Presets:
    """The profiles of the package; the first paragraph of each is its title and what it is about."""
    found = [_preset(path.read_text(encoding="utf-8")) for path in _FOLDER.glob("*.toml")]
    return Presets(presets=tuple(sorted(found, key=lambda one: one.title)))


def _preset(text: str) -> Preset:
    comment = takewhile(lambda line: line.startswith("# "), text.splitlines())
    title, _, about = " ".join(line.removeprefix("# ") for line in comment).partition(": ")
    return Preset(title=title, about=about, text=text)
