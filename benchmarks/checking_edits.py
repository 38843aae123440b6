# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""CPU of the Ruler's answer to a key in a large rule file, beside reading and checking all of it.

Run it with ``python benchmarks/checking_edits.py [--blocks 500 1000 10000] [--keys 9]``. Behind the middle of
the file, digits are written into rates, line breaks behind them, which move all that is below, and a rule,
which makes one more. Each is answered with what is known of the text before. The median of each kind is
printed by what it goes to.
"""

from __future__ import annotations

import argparse
import gc
import statistics
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from itertools import cycle, islice
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


def typed(signs: Iterable[str], text: str, keys: int) -> Iterator[str]:
    """The text after each key: one of ``signs`` behind a rate, always of another rule."""
    at = len(text) // 2
    for sign in islice(cycle(signs), keys):
        at = text.index("\n", text.index("SetFrequency", text.index("EndIf", at)))
        text = f"{text[:at]}{sign}{text[at:]}"
        yield text


def blocks_more(text: str, keys: int) -> Iterator[str]:
    """The text after each edit: half a rule more, then all of it, by turns."""
    at = text.index("EndIf", len(text) // 2) + len("EndIf\n")
    end = text.index("EndIf", at) + len("EndIf\n")
    rule = text[at:end].replace('Rule "', 'Rule "New ')
    broken = rule[: rule.index(")")]
    for key in range(keys):
        yield f"{text[:at]}{rule if key % 2 else broken}\n{text[at:]}"


KEYS: Mapping[str, Callable[[str, int], Iterator[str]]] = {
    "a digit": partial(typed, "123456789"),
    "a line break": partial(typed, "\n"),
    "a rule more or less": blocks_more,
}


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
    nothing = check_text(Draft(text="", name=NAME))
    checked, whole_ms = measured(lambda: check_text(Draft(text=text, name=NAME), nothing))
    # The page has the first answer before anybody types.
    rule_document(checked)
    print(f"{blocks} blocks: all of it read and checked {whole_ms:.0f} ms; a key (target {TARGET_MS} ms):")
    for kind, edits in KEYS.items():
        costs_ms: list[dict[str, float]] = []
        for edited in edits(text, keys):
            text = edited
            checked, cost_ms = answered(text, checked)
            costs_ms.append(cost_ms)
        total_ms = statistics.median(sum(cost.values()) for cost in costs_ms)
        by_part = {part: statistics.median(cost[part] for cost in costs_ms) for part in costs_ms[0]}
        parts = ", ".join(f"{part} {part_ms:.0f}" for part, part_ms in by_part.items())
        print(f"  {kind} {total_ms:.0f} ms: {parts}")


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
