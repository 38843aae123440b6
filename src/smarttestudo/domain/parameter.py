# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the node, by which a robot is set up and changed from afar."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum

ParameterValue = bool | int | float | str | tuple[str, ...] | None
"""``None`` is a parameter that is not set. ROS has more types; a value of those comes as text."""

Accept = Callable[[Mapping[str, ParameterValue]], None]
"""Takes parameters that somebody sets together; a ``TestudoError`` refuses all of them and says why."""


class Access(Enum):
    """Who changes a parameter once the node runs."""

    NOBODY = "nobody"
    ANYONE = "anyone"
    NODE = "node"


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """``value`` counts where the node's start-up gives no other, or, if it ``is_final``, always.

    ``is_typed``: only values of the type of ``value`` are taken.
    """

    name: str
    description: str
    value: ParameterValue
    access: Access = Access.NOBODY
    is_final: bool = False
    is_typed: bool = True
