# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The files of the project that the page has open."""

from __future__ import annotations

from importlib.util import find_spec

from msgspec import Struct

from smarttestudo import __version__
from smarttestudo.adapters.files.project_folder import FoundFile, ProjectFolder


class Project(Struct, frozen=True, kw_only=True):
    """``GET /api/project``. ``opened`` is the file that the command line named, if any.

    A bag is named by its folder, or by its file where it has no metadata. ``ros`` is whether the server can
    reach ROS 2; ``version`` is that of SmartTestudo. ``root_hash`` tells folders of one name apart.
    """

    root_name: str
    root_hash: str
    opened: str | None
    files: tuple[FoundFile, ...]
    version: str
    ros: bool
    has_more: bool


class FileAnswer(Struct, frozen=True, kw_only=True):
    """``GET /api/file?name=``: the text with its SHA-256, which a later PUT names."""

    name: str
    text: str
    hash: str


class SaveRequest(Struct, frozen=True, kw_only=True):
    """``PUT /api/file``: ``base_hash`` is what the editor read; null where the file must not exist yet."""

    name: str
    text: str
    base_hash: str | None = None


class SaveAnswer(Struct, frozen=True, kw_only=True):
    """The SHA-256 of what is on disk now."""

    hash: str


class ProjectFiles:
    """The files of ``folder``; ``opened`` is the one that the user named, if any."""

    def __init__(self, folder: ProjectFolder, opened: str | None) -> None:
        self._folder = folder
        self._opened = opened

    def project(self) -> Project:
        """What there is to open."""
        files, has_more = self._folder.files()
        return Project(
            root_name=self._folder.name,
            root_hash=self._folder.path_hash,
            opened=self._opened,
            files=tuple(files),
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
