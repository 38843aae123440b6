# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page asks about the files of its project."""

from __future__ import annotations

from importlib.util import find_spec

from smarttestudo import __version__
from smarttestudo.adapters.files.project_folder import ProjectFolder
from smarttestudo.web.schemas import FileAnswer, ProjectAnswer, ProjectFile, SaveAnswer, SaveRequest


class ProjectApi:
    """The files of ``folder``; ``opened`` is the one that the user named, if any."""

    def __init__(self, folder: ProjectFolder, opened: str | None) -> None:
        self._folder = folder
        self._opened = opened

    def project(self) -> ProjectAnswer:
        """What there is to open."""
        files, has_more = self._folder.files()
        return ProjectAnswer(
            root_name=self._folder.name,
            opened=self._opened,
            files=tuple(
                ProjectFile(name=one.name, kind=one.kind.value, size_bytes=one.size_bytes) for one in files
            ),
            version=__version__,
            ros=find_spec("rclpy") is not None,
            has_more=has_more,
        )

    def read(self, name: str) -> FileAnswer:
        """One text file."""
        found = self._folder.read(name)
        return FileAnswer(name=name, text=found.text, hash=found.sha256)

    def save(self, request: SaveRequest) -> SaveAnswer:
        """Write one text file."""
        return SaveAnswer(hash=self._folder.write(request.name, request.text, request.base_hash))
