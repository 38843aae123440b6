# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""ROS domains that no other test run on this machine has."""

from __future__ import annotations

from contextlib import AbstractContextManager

from first_free import first_free

# Domains above have ports that Linux gives to others.
DOMAINS = range(1, 102)


def free_domain() -> AbstractContextManager[int]:
    return first_free("domain", DOMAINS)
