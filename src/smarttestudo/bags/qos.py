# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Quality-of-service profiles as bags hold them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from enum import Enum
from functools import lru_cache
from typing import Any, TypeVar

from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from smarttestudo.bags.metadata_text import qos_entry

_Policy = TypeVar("_Policy", bound=Enum)
_TEXTS_KEPT = 64
_UNLIMITED = QosTime(9223372036, 854775807)


def qos_profiles(stored: object) -> tuple[Qos, ...]:
    """The profiles in an ``offered_qos_profiles``: YAML up to version 8 of the metadata, a list from 9 on.

    Raises ``ValueError`` where it holds something else.
    """
    return _parsed_text(stored) if isinstance(stored, str) else _parse(stored)


# The topics of all recordings mostly share a few texts, and YAML is slow.
@lru_cache(maxsize=_TEXTS_KEPT)
def _parsed_text(stored: str) -> tuple[Qos, ...]:
    return _parse(stored)


def _parse(stored: Any) -> tuple[Qos, ...]:
    try:
        entries = YAML(typ="base").load(stored) if isinstance(stored, str) and stored else stored
        profiles = [entries] if isinstance(entries, Mapping) else entries
        return tuple(map(_profile, profiles)) if stored else ()
    except (YAMLError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError("these are no QoS profiles") from error


def _profile(entry: Mapping[str, Any]) -> Qos:
    """The profile in an entry of texts; a policy that is missing, or of another name or number, is unknown.

    What else is missing, as where somebody wrote it, is as rosbag2 has it where nobody set it.
    """
    return Qos(
        history=_policy(QosHistory, entry, "history"),
        depth=int(entry.get("depth", "0")),
        reliability=_policy(QosReliability, entry, "reliability"),
        durability=_policy(QosDurability, entry, "durability"),
        deadline=_time(entry.get("deadline")),
        lifespan=_time(entry.get("lifespan")),
        liveliness=_policy(QosLiveliness, entry, "liveliness"),
        liveliness_lease_duration=_time(entry.get("liveliness_lease_duration")),
        avoid_ros_namespace_conventions=entry.get("avoid_ros_namespace_conventions", "").lower() == "true",
    )


def _policy(kind: type[_Policy], entry: Mapping[str, Any], name: str) -> _Policy:
    try:
        stored = entry[name]
        return kind(int(stored)) if stored.isdecimal() else kind[stored.upper()]
    except (KeyError, ValueError):
        return kind["UNKNOWN"]


def _time(entry: Mapping[str, Any] | None) -> QosTime:
    return _UNLIMITED if entry is None else QosTime(int(entry["sec"]), int(entry["nsec"]))


def qos_text(profiles: Iterable[object]) -> str:
    """``profiles`` as version 8 of the metadata has them."""
    return "\n".join(_entry(profile) for profile in profiles if isinstance(profile, Qos))


def _entry(profile: Qos) -> str:
    return qos_entry(
        history=profile.history.value,
        depth=profile.depth,
        reliability=profile.reliability.value,
        durability=profile.durability.value,
        deadline=_time_text(profile.deadline),
        lifespan=_time_text(profile.lifespan),
        liveliness=profile.liveliness.value,
        liveliness_lease_duration=_time_text(profile.liveliness_lease_duration),
        avoid_ros_namespace_conventions=profile.avoid_ros_namespace_conventions,
    )


def _time_text(time: QosTime) -> str:
    return f"{{sec: {time.sec}, nsec: {time.nsec}}}"


def is_transient_local(profiles: Iterable[object]) -> bool:
    """Whether any of ``profiles`` keeps its last messages for late subscribers."""
    return any(
        isinstance(profile, Qos) and profile.durability is QosDurability.TRANSIENT_LOCAL
        for profile in profiles
    )


def qos_in_words(profiles: Iterable[object]) -> str:
    """The offered ``profiles`` as in ``reliable, volatile, keep last 10``, each kind once."""
    words = (_in_words(profile) for profile in profiles if isinstance(profile, Qos))
    return " or ".join(dict.fromkeys(words))


def _in_words(profile: Qos) -> str:
    history = _word(profile.history)
    if profile.history is QosHistory.KEEP_LAST and profile.depth:
        history += f" {profile.depth}"
    return f"{_word(profile.reliability)}, {_word(profile.durability)}, {history}"


def _word(policy: Enum) -> str:
    return policy.name.lower().replace("_", " ")
