# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A rule file as statements with their places, and edits that touch one statement and nothing else."""

from smarttestudo.adirf.document.document import Document, Entry, Part, read_document
from smarttestudo.adirf.document.edits import (
    EditError,
    NewStatement,
    deleted,
    inserted,
    inserted_all,
    moved,
    replaced,
    replaced_all,
)
from smarttestudo.adirf.document.meaning import meaning
from smarttestudo.adirf.document.places import Places
from smarttestudo.adirf.document.splices import Splice, apply, comment_texts

__all__ = [
    "Document",
    "EditError",
    "Entry",
    "NewStatement",
    "Part",
    "Places",
    "Splice",
    "apply",
    "comment_texts",
    "deleted",
    "inserted",
    "inserted_all",
    "meaning",
    "moved",
    "read_document",
    "replaced",
    "replaced_all",
]
