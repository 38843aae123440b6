# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Colours, dashes and hatches, the same in the report and in figures."""

from __future__ import annotations

from collections.abc import Mapping

LIGHT: Mapping[str, str] = {
    "paper": "#fdfdfc",
    "panel": "#ffffff",
    "ink": "#1d2430",
    "quiet": "#5d6878",
    "faint": "#e6e8ec",
    "line": "#d3d8df",
    "wall": "#525c6b",
    "rack": "#c9cfd8",
    "before": "#9aa3b0",
    "default": "#8b95a4",
    "doubt": "#8b95a4",
    "other": "#5d6878",
    "rule-1": "#0a66b0",
    "rule-2": "#e08a00",
    "rule-3": "#00785c",
    "rule-4": "#c25b9b",
    "rule-5": "#4aa8de",
    "rule-6": "#c2410c",
    "share-1": "#23445f",
    "share-2": "#3f7ba6",
    "share-3": "#7fb2d0",
    "share-4": "#c9b458",
    "share-5": "#e2a36b",
    "share-6": "#b96a5a",
    "share-7": "#c5cbd3",
}
DARK: Mapping[str, str] = {
    "paper": "#12161d",
    "panel": "#171c25",
    "ink": "#e8ebf0",
    "quiet": "#9da7b6",
    "faint": "#262d38",
    "line": "#363f4c",
    "wall": "#aab3c0",
    "rack": "#3b4452",
    "before": "#6c7686",
    "default": "#8d97a6",
    "doubt": "#8d97a6",
    "other": "#b3bcc9",
    "rule-1": "#58a9f0",
    "rule-2": "#f2b13c",
    "rule-3": "#3ec49b",
    "rule-4": "#e58fc6",
    "rule-5": "#9bd5f7",
    "rule-6": "#ff8d5c",
    "share-1": "#a9cfe8",
    "share-2": "#6fa8d0",
    "share-3": "#41769f",
    "share-4": "#b7a24c",
    "share-5": "#d18f55",
    "share-6": "#a45848",
    "share-7": "#4a5361",
}
ON_PAPER: Mapping[str, str] = {
    **LIGHT,
    "paper": "#ffffff",
    "ink": "#000000",
    "quiet": "#444b55",
    "faint": "#e0e3e8",
    "line": "#c8cdd5",
    "before": "#8a93a0",
}
DASHES: Mapping[str, tuple[int, ...]] = {
    "doubt": (4, 8),
    "other": (1, 5),
    "rule-2": (13, 7),
    "rule-3": (2, 7),
    "rule-4": (14, 6, 2, 6),
    "rule-5": (7, 6),
    "rule-6": (12, 5, 2, 5, 2, 5),
}
"""Lengths of strokes and gaps on a path, whose width is ``PATH_WIDTH`` and whose strokes have round ends."""
PATH_WIDTH, DEFAULTS_WIDTH = 4.0, 2.5
BUDGET_DASH = (8, 5)
MAX_LANES = 24


def colour_sheet() -> str:
    """The colours as a style sheet: for light, dark and paper."""
    rules = (name for name in LIGHT if name in {"default", "doubt", "other"} or name.startswith("rule-"))
    shares = (name for name in LIGHT if name.startswith("share-"))
    return "\n".join(
        (
            _variables(LIGHT),
            f"@media (prefers-color-scheme: dark) {{ {_variables(DARK)} }}",
            f"@media print {{ {_variables(ON_PAPER)} }}",
            *(f".by-{name} {{ --rule: var(--{name});{_dash(name)} }}" for name in rules),
            *(f".{name} {{ fill: var(--{name}); }}" for name in shares),
        )
    )


def _variables(colours: Mapping[str, str]) -> str:
    return f":root {{ {' '.join(f'--{name}: {colour};' for name, colour in colours.items())} }}"


def _dash(name: str) -> str:
    return f" --dash: {' '.join(map(str, DASHES[name]))};" if name in DASHES else ""


def row_sheet() -> str:
    """The style rules that number the lanes; the number of the drawing is that of its lanes."""
    return "\n".join(f".{row_class(row)} {{ --row: {row}; }}" for row in range(MAX_LANES + 1))


def row_class(row: int) -> str:
    """The class of a lane by its number, and of a drawing by that of its lanes."""
    return f"row-{row}"
