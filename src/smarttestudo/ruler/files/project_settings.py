# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Settings for everybody who opens a project in the Ruler, in a hidden file of the project."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace

from smarttestudo.domain.errors import TestudoError
from smarttestudo.files.input_file import read_input
from smarttestudo.files.whole_file import not_written, whole_file
from smarttestudo.ruler.files.project_folder import ProjectFolder

SETTINGS_FILE = ".testudo/settings.json"
_MAX_BYTES = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class ProjectSettings:
    """``saves_by_itself`` is whether the page saves what was changed without being asked.

    ``profiles`` names the profile that somebody chose for a rule file, empty for none.
    """

    saves_by_itself: bool = False
    profiles: Mapping[str, str] = field(default_factory=dict)


class SettingsFile:
    """The settings of ``folder``; changes of one process are made one after the other."""

    def __init__(self, folder: ProjectFolder) -> None:
        self._folder = folder
        self._changing = threading.Lock()

    def read(self) -> ProjectSettings:
        """The settings; the usual ones where there are none, or none that can be read."""
        with suppress(OSError, ValueError, RecursionError):
            found = json.loads(read_input(self._folder.path(SETTINGS_FILE), _MAX_BYTES))
            if isinstance(found, dict):
                return ProjectSettings(
                    saves_by_itself=found.get("saves_by_itself") is True,
                    profiles=_names(found.get("profiles")),
                )
        return ProjectSettings()

    def set_saves_by_itself(self, *, is_wanted: bool) -> None:
        """Write whether the page saves by itself; ``OutputFileError`` where that is not possible."""
        self._change(lambda settings: replace(settings, saves_by_itself=is_wanted))

    def set_profile(self, rules: str, profile: str) -> None:
        """Write that ``rules`` go with ``profile``, empty for none; ``OutputFileError`` as above.

        What was chosen for rule files that are gone is forgotten.
        """

        def chosen(settings: ProjectSettings) -> ProjectSettings:
            kept = {name: each for name, each in settings.profiles.items() if self._is_there(name)}
            return replace(settings, profiles={**kept, rules: profile})

        self._change(chosen)

    def follow(self, name: str, new_name: str) -> None:
        """Write that what was called ``name`` is called ``new_name``; ``OutputFileError`` as above."""

        def renamed(one: str) -> str:
            return new_name if one == name else one

        def followed(settings: ProjectSettings) -> ProjectSettings:
            chosen = {renamed(rules): renamed(profile) for rules, profile in settings.profiles.items()}
            return replace(settings, profiles=chosen)

        self._change(followed)

    def _change(self, changed: Callable[[ProjectSettings], ProjectSettings]) -> None:
        with self._changing:
            before = self.read()
            after = changed(before)
            if after != before:
                self._write(after)

    def _write(self, settings: ProjectSettings) -> None:
        path = self._folder.path(SETTINGS_FILE)
        try:
            path.parent.mkdir(exist_ok=True)
        except OSError as error:
            raise not_written(path, "the settings of the project", error) from error
        with whole_file(path, "the settings of the project") as write:
            write(f"{json.dumps(asdict(settings), indent=1)}\n")

    def _is_there(self, name: str) -> bool:
        with suppress(OSError, ValueError, TestudoError):
            return self._folder.path(name).is_file()
        return False


def _names(found: object) -> dict[str, str]:
    """The part of ``found`` that pairs names with names."""
    pairs = found.items() if isinstance(found, dict) else ()
    return {key: each for key, each in pairs if isinstance(key, str) and isinstance(each, str)}
