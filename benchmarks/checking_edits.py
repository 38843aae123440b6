# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""CPU of the Ruler's answer to a key in a large rule file, beside reading and checking all of it.

Run it with ``python benchmarks/checking_edits.py [--blocks 500 1000 10000] [--keys 9]``. Digits are written
into rates behind the middle of the file, each answered with what is known of the text before; then a line
break, which moves all that is below. The median of the keys is printed by what it goes to.
"""

from __future__ import annotations

import argparse
import gc
import statistics
import time
from collections.abc import Callable, Iterator
from typing import TypeVar

from live.zone_rules import rule_file
from smarttestudo.language.parser import parse
from smarttestudo.ruler.answers.answer_json import answer_json
from smarttestudo.ruler.answers.checked_text import CheckedText, Draft, check_text
from smarttestudo.ruler.answers.documents import rule_document
from smarttestudo.ruler.server.server import GC_THRESHOLDS

NAME = "rules.adirf"
TARGET_MS = 150
_T = TypeVar("_T")


def measured(work: Callable[[], _T]) -> tuple[_T, float]:
    """What ``work`` returns, and its CPU in ms."""
    start_s = time.process_time()
    result = work()
    return result, (time.process_time() - start_s) * 1000


def edits(text: str, keys: int) -> Iterator[str]:
    """The text after each key: a digit behind a rate, always of another rule."""
    at = len(text) // 2
    for key in range(keys):
        at = text.index("\n", text.index("SetFrequency", text.index("EndIf", at)))
        text = f"{text[:at]}{key % 9 + 1}{text[at:]}"
        yield text


def answered(text: str, before: CheckedText) -> tuple[CheckedText, dict[str, float]]:
    """The answer to a text, and what each part of it cost in ms."""
    draft = Draft(text=text, name=NAME)
    _, parse_ms = measured(lambda: parse(text, NAME, before.document.result))
    checked, check_ms = measured(lambda: check_text(draft, before))
    document, page_ms = measured(lambda: rule_document(checked))
    _, json_ms = measured(lambda: answer_json(document))
    costs_ms = {"reading": parse_ms, "checking": check_ms - parse_ms, "statements": page_ms, "JSON": json_ms}
    return checked, costs_ms


def compare(blocks: int, keys: int) -> None:
    """Print what a key costs in a file of so many blocks."""
    text = rule_file(blocks)
    gc.collect()
    checked, whole_ms = measured(lambda: check_text(Draft(text=text, name=NAME)))
    # The page has the first answer before anybody types.
    rule_document(checked)
    costs_ms: list[dict[str, float]] = []
    for edited in edits(text, keys):
        text = edited
        checked, cost_ms = answered(text, checked)
        costs_ms.append(cost_ms)
    by_part = {part: statistics.median(cost[part] for cost in costs_ms) for part in costs_ms[0]}
    total_ms = statistics.median(sum(cost.values()) for cost in costs_ms)
    middle = text.index("\n", len(text) // 2)
    _, break_ms = measured(
        lambda: check_text(Draft(text=f"{text[:middle]}\n{text[middle:]}", name=NAME), checked)
    )
    parts = ", ".join(f"{part} {part_ms:.0f}" for part, part_ms in by_part.items())
    print(
        f"{blocks} blocks: all of it read and checked {whole_ms:.0f} ms; "
        f"a key {total_ms:.0f} ms (target {TARGET_MS}): {parts}; a line break {break_ms:.0f} ms"
    )


def main() -> None:
    """Compare files of some sizes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--blocks", type=int, nargs="+", default=[500, 1000, 10_000])
    parser.add_argument("--keys", type=int, default=9)
    options = parser.parse_args()
    gc.set_threshold(*GC_THRESHOLDS)
    for blocks in options.blocks:
        compare(blocks, options.keys)


if __name__ == "__main__":
    main()
