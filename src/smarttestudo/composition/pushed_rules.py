# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which rules hold: those of the files, or a text that was pushed and must be confirmed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

from smarttestudo.domain.units import NS_PER_S

CONFIRM_WITHIN_S = 10

_Rules = TypeVar("_Rules")


@dataclass(frozen=True, slots=True)
class _Waiting(Generic[_Rules]):
    """A pushed text that nobody confirmed yet, and what held before it."""

    text_hash: str
    until_ns: int
    before: _Rules


class PushedRules(Generic[_Rules]):
    """A pushed text holds at once, but only for ``CONFIRM_WITHIN_S`` unless its hash is confirmed by then.

    So rules that cut off whoever pushed them do not last. Times are steady.
    """

    def __init__(self, rules: _Rules) -> None:
        self.rules = rules
        self._waiting: _Waiting[_Rules] | None = None
        self._confirmed_hash: str | None = None

    @property
    def is_confirmed(self) -> bool:
        """Whether a pushed text holds for good."""
        return self._waiting is None and self._confirmed_hash is not None

    @property
    def is_pushed(self) -> bool:
        """Whether a pushed text holds, confirmed or not."""
        return self._waiting is not None or self._confirmed_hash is not None

    def waits_ns(self, now_ns: int) -> int | None:
        """How long a pushed text still waits to be confirmed; ``None`` where none does."""
        return None if self._waiting is None else max(self._waiting.until_ns - now_ns, 0)

    def replace(self, rules: _Rules) -> None:
        """Other rules hold for good, and whatever was pushed before is forgotten."""
        self.rules = rules
        self._waiting = self._confirmed_hash = None

    def push(self, rules: _Rules, text_hash: str, now_ns: int) -> None:
        """Let ``rules`` hold until they are confirmed or time is up; confirmed ones stay confirmed.

        Of texts pushed one after the other without a word, the rules before the first come back.
        """
        if text_hash == self._confirmed_hash and self._waiting is None:
            return
        before = self.rules if self._waiting is None else self._waiting.before
        self._waiting = _Waiting(text_hash, now_ns + CONFIRM_WITHIN_S * NS_PER_S, before)
        self.rules = rules

    def is_confirmable(self, text_hash: str) -> bool:
        """Whether ``text_hash`` is that of the text pushed last, waiting or confirmed already."""
        return text_hash == (self._confirmed_hash if self._waiting is None else self._waiting.text_hash)

    def confirm(self, text_hash: str) -> bool:
        """Keep the pushed text; whether it was waiting for that. Another hash changes nothing."""
        if self._waiting is None or self._waiting.text_hash != text_hash:
            return False
        self._waiting, self._confirmed_hash = None, text_hash
        return True

    def roll_back(self, now_ns: int) -> bool:
        """Go back to the rules before the pushed text if it is time; whether it was."""
        if self._waiting is None or now_ns < self._waiting.until_ns:
            return False
        self.rules, self._waiting = self._waiting.before, None
        return True
