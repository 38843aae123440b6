# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A link between network namespaces, where this machine allows one."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator

import pytest

from smarttestudo.demo.network_namespaces import ThinLink, thin_link
from smarttestudo.domain.errors import NetworkError


@pytest.fixture
def link() -> Iterator[ThinLink]:
    """One of this process, gone at the end."""
    try:
        opened = thin_link()
        made = opened.__enter__()
    except NetworkError as error:
        pytest.skip(str(error))
    try:
        yield made
    finally:
        opened.__exit__(None, None, None)


def namespaces() -> set[str]:
    """The names of all network namespaces of this machine."""
    listed = subprocess.run(["ip", "netns", "list"], capture_output=True, text=True, check=True)
    return {line.split()[0] for line in listed.stdout.splitlines()}
