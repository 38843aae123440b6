# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A thin link between two network namespaces of this machine, made with iproute2; for root only."""

from smarttestudo.demo.network_namespaces.thin_link import (
    OPERATOR_ADDRESS,
    ROBOT_ADDRESS,
    ThinLink,
    in_namespace,
    require_links,
    thin_link,
)

__all__ = ["OPERATOR_ADDRESS", "ROBOT_ADDRESS", "ThinLink", "in_namespace", "require_links", "thin_link"]
