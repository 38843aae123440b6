# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A link between network namespaces, where this machine allows one."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator

import pytest

from thin_link.network_namespaces import ThinLink, thin_link


@pytest.fixture
def link(network_namespaces: None) -> Iterator[ThinLink]:
    """One of this process, gone at the end."""
    with thin_link() as made:
        yield made


def namespaces() -> set[str]:
    """The names of all network namespaces of this machine."""
    listed = subprocess.run(["ip", "netns", "list"], capture_output=True, text=True, check=True)
    return {line.split()[0] for line in listed.stdout.splitlines()}
