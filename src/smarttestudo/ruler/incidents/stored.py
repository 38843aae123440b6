# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents on the disk of a project."""

from __future__ import annotations

from smarttestudo.bags.incident_record import RECORD_NAME
from smarttestudo.incidents.store import IncidentStore, StoredIncident
from smarttestudo.ruler.files.project_folder import MissingFileError, ProjectFolder


def incident_store(folder: ProjectFolder, name: str) -> tuple[IncidentStore, str]:
    """The store of an incident by its name in the project, and its name there.

    Raises ``MissingFileError`` where there is none.
    """
    path = folder.path(name)
    # A link is a record that cannot be read, not a folder without one.
    if not (path / RECORD_NAME).is_symlink() and not (path / RECORD_NAME).exists():
        raise MissingFileError("there is no such incident in the project", place=name)
    return IncidentStore(path.parent), path.name


def stored_incident(folder: ProjectFolder, name: str) -> StoredIncident:
    """The incident. Raises ``TestudoError`` where it is none, or cannot be read."""
    store, last = incident_store(folder, name)
    return store.incident(last)
