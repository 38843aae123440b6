# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Names of message types, those of services and actions among them."""

from __future__ import annotations

import re

from smarttestudo.domain.dataclass import dataclass

_NAME = r"[A-Za-z]\w{0,199}"
_OF_SERVICE = r"_(?:Request|Response|Event)"
_OF_ACTION = rf"_(?:Goal|Result|Feedback|FeedbackMessage|(?:SendGoal|GetResult){_OF_SERVICE})"
_TYPE = re.compile(
    rf"(?P<package>{_NAME})/(?:(?P<msg>msg)/(?P<message>{_NAME})|"
    rf"(?P<srv>srv)/(?P<service>{_NAME}?){_OF_SERVICE}|(?P<action>action)/(?P<goal>{_NAME}?){_OF_ACTION})",
    re.ASCII,
)


def short_type_name(type_name: str) -> str:
    """``std_srvs/SetBool_Event`` for ``std_srvs/srv/SetBool_Event``; a name of two parts stays."""
    package, _, rest = type_name.partition("/")
    return f"{package}/{rest.rpartition('/')[2]}" if rest else type_name


@dataclass(frozen=True, slots=True, kw_only=True)
class TypeName:
    """``std_srvs/srv/SetBool_Event``: of ``kind`` srv (or msg, action), and ``defined_in`` SetBool."""

    package: str
    kind: str
    defined_in: str
    name: str

    @classmethod
    def read(cls, text: str) -> TypeName | None:
        """``None`` where ``text`` is not the name of a type of messages."""
        match = _TYPE.fullmatch(text)
        if match is None:
            return None
        kind = match["msg"] or match["srv"] or match["action"]
        return cls(
            package=match["package"],
            kind=kind,
            defined_in=match["message"] or match["service"] or match["goal"],
            name=text.rpartition("/")[2],
        )
