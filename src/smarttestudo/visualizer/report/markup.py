# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""HTML and SVG that cannot be injected into: plain strings are always escaped, only ``Markup`` is not."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from html import escape

from smarttestudo.visualizer.table import printable

_WITHOUT_CONTENT = frozenset({"meta", "wbr", "rect", "line", "path", "circle", "polyline", "polygon"})
_KEPT_CONTROLS = "\n\t"


@dataclass(frozen=True, slots=True)
class Markup:
    """Text that is HTML already."""

    html: str


Child = Markup | str
Attribute = str | float


def tag(name: str, /, *children: Child, **attributes: Attribute) -> Markup:
    """An element; in attribute names ``_`` stands for ``-``, a last ``_`` for nothing (``class_``).

    Floating-point attributes are coordinates and keep one decimal.
    """
    written = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{_value(value)}"' for key, value in attributes.items()
    )
    if name in _WITHOUT_CONTENT and not children:
        return Markup(f"<{name}{written}/>")
    return Markup(f"<{name}{written}>{join(children).html}</{name}>")


def join(children: Iterable[Child]) -> Markup:
    """``children`` one after the other."""
    return Markup("".join(one.html if isinstance(one, Markup) else _text(one) for one in children))


def name_parts(topic: str) -> list[Child]:
    """A topic's name that may break before each of its slashes."""
    first, *others = topic.split("/")
    parts: list[Child] = [first]
    for other in others:
        parts += [tag("wbr"), f"/{other}"]
    return parts


def coordinate(value: float) -> str:
    """``value`` with at most one decimal."""
    return f"{value:.1f}".removesuffix(".0")


def _value(value: Attribute) -> str:
    return coordinate(value) if isinstance(value, float) else _text(str(value))


def _text(text: str) -> str:
    """``text`` escaped, line breaks and tabs kept, other control characters and lone surrogates replaced."""
    if not text.isprintable():
        text = "".join(one if one in _KEPT_CONTROLS else printable(one) for one in text)
    return escape(text)
