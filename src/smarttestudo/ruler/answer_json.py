# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Answers as JSON."""

from __future__ import annotations

import msgspec
from msgspec import Struct

from smarttestudo.domain.record import to_json


def answer_json(answer: object) -> bytes:
    """Encode ``answer``: a struct as msgspec does, a record as it stands in a status or ``--json``.

    A struct holds no record whose JSON is other than its fields; the generator of the page's types refuses
    one that does.
    """
    return msgspec.json.encode(answer if isinstance(answer, Struct) else to_json(answer))
