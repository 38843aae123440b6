# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A rule file as statements with their places, and edits that touch one statement and nothing else."""

from smarttestudo.editing.document import CollectionPart, Document, Entry, meaning, read_document
from smarttestudo.editing.edits import (
    EditError,
    NewStatement,
    deleted,
    duplicated,
    inserted,
    inserted_all,
    moved,
    replaced,
    takes_in,
)
from smarttestudo.editing.text_edit import LineIndex, TextEdit, apply, comment_texts

__all__ = [
    "CollectionPart",
    "Document",
    "EditError",
    "Entry",
    "LineIndex",
    "NewStatement",
    "TextEdit",
    "apply",
    "comment_texts",
    "deleted",
    "duplicated",
    "inserted",
    "inserted_all",
    "meaning",
    "moved",
    "read_document",
    "replaced",
    "takes_in",
]
