# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the Ruler's page and server say to each other, in JSON.

Every request with a body is a POST or PUT of one of the ``…Request``s. An error is ``ErrorAnswer`` with a
status from 400 on. Texts come and go whole; ``name`` is a file's name in the project, with ``/`` between
folders, and only says what findings call the text. ``profile_text`` is the text of a profile, or null, and
``profile_name`` what errors call it.
"""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

from smarttestudo.optimizer.model import Model
from smarttestudo.web.statement_schemas import AnyStatement, DocumentModel, FindingModel
from smarttestudo.web.zone_schemas import MoveZone, NewZone, ResizeZone

PROTOCOL_VERSION = 1
FileKindName = Literal["rules", "profile", "bag", "map", "layout", "image"]


class Problem(Struct, frozen=True, kw_only=True):
    """Why something was refused; ``place`` and ``remedy`` may be empty.

    ``findings`` say why, where rules with errors were refused.
    """

    message: str
    place: str = ""
    remedy: str = ""
    findings: tuple[FindingModel, ...] = ()


class ErrorAnswer(Struct, frozen=True, kw_only=True):
    """The body of every answer that is an error."""

    error: Problem


class ProjectFile(Struct, frozen=True, kw_only=True):
    """A file of the project; a bag is named by its folder, or by its file where it has no metadata."""

    name: str
    kind: FileKindName
    size_bytes: int


class ProjectAnswer(Struct, frozen=True, kw_only=True):
    """``GET /api/project``. ``opened`` is the file that the command line named, if any.

    ``ros`` is whether the server can reach ROS 2; ``version`` is that of SmartTestudo.
    """

    root_name: str
    opened: str | None
    files: tuple[ProjectFile, ...]
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


class DocumentRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/document`` → ``DocumentModel``; ``/api/format`` and ``/api/download`` → ``TextAnswer``."""

    text: str
    name: str = "rules.adirf"
    profile_text: str | None = None
    profile_name: str = "profile.toml"


class FixRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/fix`` → ``EditAnswer``: apply the fix of the finding ``index`` of this very text."""

    text: str
    index: int
    name: str = "rules.adirf"
    profile_text: str | None = None
    profile_name: str = "profile.toml"


class Replace(Struct, frozen=True, kw_only=True, tag_field="kind", tag="replace"):
    """Write ``statement`` in the place of statement ``id``; only what differs is touched.

    Comments stay where ``statement.comments`` is null; a list replaces those directly above.
    """

    id: str
    statement: AnyStatement


class Insert(Struct, frozen=True, kw_only=True, tag_field="kind", tag="insert"):
    """Put ``statement`` before number ``index`` of ``collection``; its length puts it at the end."""

    collection: str
    index: int
    statement: AnyStatement


class Delete(Struct, frozen=True, kw_only=True, tag_field="kind", tag="delete"):
    """Delete statement ``id`` with its own comments."""

    id: str


class Move(Struct, frozen=True, kw_only=True, tag_field="kind", tag="move"):
    """Move statement ``id``; ``index`` counts the other statements of ``collection``."""

    id: str
    collection: str
    index: int


AnyEdit = Replace | Insert | Delete | Move | NewZone | MoveZone | ResizeZone


class EditRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/edit`` → ``EditAnswer``."""

    text: str
    edit: AnyEdit
    name: str = "rules.adirf"
    profile_text: str | None = None
    profile_name: str = "profile.toml"


class EditAnswer(Struct, frozen=True, kw_only=True):
    """The new text and its document; ``id`` is the statement that was written or moved, if any."""

    text: str
    document: DocumentModel
    id: str | None


class TextAnswer(Struct, frozen=True, kw_only=True):
    """One text."""

    text: str


class PropertyModel(Struct, frozen=True, kw_only=True):
    """A property that a check can read; ``minimum`` and ``maximum`` bound its values where they are known."""

    name: str
    unit: str
    meaning: str
    minimum: float | None
    maximum: float | None


class VocabularyTopic(Struct, frozen=True, kw_only=True):
    """A topic to suggest: its type where known, the type's properties, and who names it."""

    topic: str
    type: str | None
    properties: tuple[PropertyModel, ...]
    source: Literal["profile", "robot", "bag", "rules", "example"]


class VocabularyRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/vocabulary`` (or GET with ``profile`` and ``bag``, names of files of the project)."""

    text: str | None = None
    profile_text: str | None = None
    bag: str | None = None


class VocabularyAnswer(Struct, frozen=True, kw_only=True):
    """What an editor suggests; ``every_topic`` are the properties of any topic."""

    topics: tuple[VocabularyTopic, ...]
    every_topic: tuple[PropertyModel, ...]
    by_type: dict[str, tuple[PropertyModel, ...]]
    tiers: tuple[str, ...]
    operators: tuple[str, ...]


class ProfileRow(Struct, frozen=True, kw_only=True):
    """One topic of the profile's table; sizes in KB of 1000 B, rates in Hz. Null is "not given"."""

    topic: str
    type: str | None = None
    message_kb: float | None = None
    source_hz: float | None = None
    tiers_hz: tuple[float, float, float, float, float, float] | None = None
    priority: float | None = None
    min_hz: float | None = None
    max_hz: float | None = None


class ProfileParseRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/profile/parse`` → ``ProfileTable``."""

    text: str
    name: str = "profile.toml"


class ProfileTable(Struct, frozen=True, kw_only=True):
    """The topics of a profile in the order of the file, and its budget in KB/s."""

    rows: tuple[ProfileRow, ...]
    budget_kb_per_s: float | None


class ProfileWriteRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/profile/write`` → ``TextAnswer``: ``base_text`` with the values of the table.

    Comments, order and keys that the table does not show stay. Topics that are not in ``rows`` are removed.
    """

    rows: tuple[ProfileRow, ...]
    budget_kb_per_s: float | None = None
    base_text: str = ""
    name: str = "profile.toml"


class ProfileMeasureRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/profile/measure`` → ``TextAnswer``: a profile measured in a bag of the project."""

    bag: str


class OptimizeRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/optimize`` → ``OptimizeAnswer``; 409 with findings for rules with errors."""

    text: str
    profile_text: str
    name: str = "rules.adirf"
    profile_name: str = "profile.toml"
    model: Model = Model.QUPER
    only_named: bool = False


class TopicLoad(Struct, frozen=True, kw_only=True):
    """What one topic takes of the link in one situation; ``rate_hz`` is null for Full."""

    topic: str
    rate_hz: float | None
    kb_per_s: float


class SituationModel(Struct, frozen=True, kw_only=True):
    """The loads of all relayed topics: by default, in one rule's block, or in the worst case.

    ``rules`` are the ids of the statements that hold, ``state`` an example of values (``"/odom pose_x"``).
    """

    kind: Literal["defaults", "rule", "worst"]
    title: str
    rules: tuple[str, ...]
    state: dict[str, float]
    loads: tuple[TopicLoad, ...]
    kb_per_s: float
    feasible: bool


class RepairEdit(Struct, frozen=True, kw_only=True):
    """Replace a stretch of the rule file's text."""

    offset: int
    end_offset: int
    replacement: str


class Repair(Struct, frozen=True, kw_only=True):
    """One way to make a part fit, best first: edits of the rules, or a budget to set."""

    title: str
    edits: tuple[RepairEdit, ...]
    budget_kb_per_s: float | None


class Refusal(Struct, frozen=True, kw_only=True):
    """Why a part does not fit; ``rule`` is the statement's id, null for the defaults."""

    rule: str | None
    message: str
    needs_kb_per_s: float
    repairs: tuple[Repair, ...]


class OptimizeAnswer(Struct, frozen=True, kw_only=True):
    """The rates. ``result`` is what ``testudo optimize --json`` prints.

    ``download_text`` is the rule file with numbers; null where not everything fits.
    """

    feasible: bool
    budget_kb_per_s: float
    situations: tuple[SituationModel, ...]
    refusals: tuple[Refusal, ...]
    download_text: str | None
    result: dict[str, object]


class DifferenceRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/diff`` → ``DifferenceAnswer``: what differs for a robot between two texts."""

    old_text: str
    new_text: str


class DifferenceAnswer(Struct, frozen=True, kw_only=True):
    """Sentences such as ``Corridor: /scan 4 → 6 Hz``; none where only the layout differs."""

    changes: tuple[str, ...]


class Hello(Struct, frozen=True, kw_only=True, tag_field="kind", tag="hello"):
    """The first message on ``/ws``; a page that knows another protocol asks to be reloaded."""

    version: str
    protocol: int = PROTOCOL_VERSION


class Progress(Struct, frozen=True, kw_only=True, tag_field="kind", tag="progress"):
    """How far the try ``run`` is, 0 … 1."""

    run: str
    share: float
