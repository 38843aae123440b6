# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What everybody who opens a project in the Ruler wants, in a hidden file of the project."""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import asdict, dataclass

from smarttestudo.adapters.files.input_file import read_input
from smarttestudo.adapters.files.project_folder import ProjectFolder
from smarttestudo.adapters.files.whole_file import not_written, whole_file

SETTINGS_FILE = ".testudo/settings.json"
_MAX_BYTES = 10_000


@dataclass(frozen=True, slots=True, kw_only=True)
class ProjectSettings:
    """``saves_by_itself`` is whether the page saves what was changed without being asked."""

    saves_by_itself: bool = False


def read_settings(folder: ProjectFolder) -> ProjectSettings:
    """The settings of ``folder``; the usual ones where there are none, or none that can be read."""
    with suppress(OSError, ValueError, RecursionError):
        found = json.loads(read_input(folder.path(SETTINGS_FILE), _MAX_BYTES))
        if isinstance(found, dict):
            return ProjectSettings(saves_by_itself=found.get("saves_by_itself") is True)
    return ProjectSettings()


def write_settings(folder: ProjectFolder, settings: ProjectSettings) -> None:
    """Write the settings of ``folder``; ``OutputFileError`` where that is not possible."""
    path = folder.path(SETTINGS_FILE)
    try:
        path.parent.mkdir(exist_ok=True)
    except OSError as error:
        raise not_written(path, "the settings of the project", error) from error
    with whole_file(path, "the settings of the project") as write:
        write(f"{json.dumps(asdict(settings), indent=1)}\n")
