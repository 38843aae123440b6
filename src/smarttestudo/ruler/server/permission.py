# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Permission of somebody here: to change files and robots, or only to watch."""

from __future__ import annotations

from enum import Enum

from starlette.types import Scope

_KEY = "testudo.permission"
_READING = frozenset(("GET", "HEAD", "OPTIONS"))
_READING_POSTS = frozenset(
    f"/api/{path}"
    for path in (
        "background",
        "background/path",
        "check/course",
        "difference",
        "document",
        "edit",
        "export",
        "format",
        "import",
        "import/preview",
        "incident",
        "incident/course",
        "optimize",
        "profile/accuracy",
        "profile/check",
        "profile/curve",
        "profile/entry",
        "profile/for",
        "profile/levels",
        "profile/measure",
        "profile/parse",
        "profile/write",
        "push/lasting",
        "push/preview",
        "recording",
        "robot/checks",
        "robot/history",
        "robot/start",
        "try",
        "try/headline",
        "version",
        "vocabulary",
        "zones",
        "zones/cover",
    )
)
"""What is asked with a body and changes neither a file nor a robot."""


class Permission(Enum):
    """Permission of a request."""

    CHANGE = "change"
    WATCH = "watch"


def note_permission(scope: Scope, permission: Permission) -> None:
    """Keep what the sender of a request may do with the request."""
    scope[_KEY] = permission


def noted_permission(scope: Scope) -> Permission:
    """Permission that was noted for the sender of a request."""
    permission: Permission = scope[_KEY]
    return permission


def only_reads(method: str, path: str) -> bool:
    """Whether a request changes neither a file nor a robot, whatever its body says."""
    return method in _READING or (method == "POST" and path in _READING_POSTS)
