# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One server of the examples for all tests that change nothing in them."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from ruler.ruler_server import EXAMPLES, Page, served


@pytest.fixture(scope="session")
def examples_page() -> Iterator[Page]:
    with served(EXAMPLES, opened="warehouse.adirf") as page:
        yield page
