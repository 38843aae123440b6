# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page and the server say about zones and what lies below them, in JSON. Lengths are metres."""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

BackgroundKind = Literal["map", "image"]


class RectangleModel(Struct, frozen=True, kw_only=True):
    """An upright rectangle; null is a side that nothing bounds."""

    min_x: float | None
    max_x: float | None
    min_y: float | None
    max_y: float | None


class ZoneModel(Struct, frozen=True, kw_only=True):
    """A rectangle of a rule. ``is_shared`` is whether a check of it bounds another rectangle as well."""

    topic: str
    rectangle: RectangleModel
    is_shared: bool


class RuleZonesModel(Struct, frozen=True, kw_only=True):
    """The zones of the rule ``id``, in any of which it may hold.

    ``others`` are its checks that bound no zone, as text; ``holds_elsewhere`` is whether it can hold outside
    its zones; ``is_too_mixed`` says that its condition is too mixed to be drawn.
    """

    id: str
    label: str
    zones: tuple[ZoneModel, ...]
    others: tuple[str, ...]
    holds_elsewhere: bool
    is_too_mixed: bool


class ZoneClashModel(Struct, frozen=True, kw_only=True):
    """Two rules that clash with a zone in ``common``; ``message`` and ``hint`` are the checker's."""

    first: str
    second: str
    message: str
    hint: str
    common: tuple[RectangleModel, ...]


class ZonesAnswer(Struct, frozen=True, kw_only=True):
    """``POST /api/zones`` with a ``DocumentRequest``. ``label`` is a name for a new zone that no rule has."""

    rules: tuple[RuleZonesModel, ...]
    clashes: tuple[ZoneClashModel, ...]
    label: str


class CoverRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/zones/cover`` → ``CoverAnswer``: the corners of a polygon, in its order."""

    corners: tuple[tuple[float, float], ...]
    max_rectangles: int = 8


class CoverAnswer(Struct, frozen=True, kw_only=True):
    """Rectangles that share no area and hold the polygon; ``over_m2`` is what they cover beside it."""

    rectangles: tuple[RectangleModel, ...]
    polygon_m2: float
    over_m2: float


class NewZone(Struct, frozen=True, kw_only=True, tag_field="kind", tag="zone_new"):
    """An edit: make ``rectangles`` the condition of rule ``into``, or, if that is null, of a new one."""

    topic: str
    rectangles: tuple[RectangleModel, ...]
    into: str | None = None
    label: str = "Zone"


class MoveZone(Struct, frozen=True, kw_only=True, tag_field="kind", tag="zone_move"):
    """An edit: move all zones of rule ``id`` on ``topic``, in whole centimetres."""

    id: str
    topic: str
    dx: float
    dy: float


class ResizeZone(Struct, frozen=True, kw_only=True, tag_field="kind", tag="zone_resize"):
    """An edit: give zone number ``index`` of rule ``id`` other sides."""

    id: str
    index: int
    rectangle: RectangleModel


class BackgroundChoice(Struct, frozen=True, kw_only=True):
    """A map, image or recording of the project."""

    kind: Literal["map", "image", "bag"]
    name: str


class BackgroundsAnswer(Struct, frozen=True, kw_only=True):
    """``GET /api/backgrounds``: what zones can be drawn on."""

    choices: tuple[BackgroundChoice, ...]


class BackgroundRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/background`` → ``BackgroundAnswer``."""

    kind: BackgroundKind
    name: str


class BackgroundAnswer(Struct, frozen=True, kw_only=True):
    """A map or image; ``GET /api/background/picture?kind=…&name=…`` is its picture, always PNG.

    ``hash`` is that of its files, to see whether they changed; ``metres_per_pixel`` is null for an image.
    The lower left corner of the picture lies at (``x``, ``y``), turned about it by ``yaw_rad``.
    """

    kind: BackgroundKind
    name: str
    hash: str
    width_px: int
    height_px: int
    metres_per_pixel: float | None
    x: float
    y: float
    yaw_rad: float


class PathRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/background/path`` → ``PathAnswer``."""

    bag: str


class PathAnswer(Struct, frozen=True, kw_only=True):
    """Where the robot of a recording was: seconds since its start, x and y in metres."""

    path: tuple[tuple[float, float, float], ...]
    notices: tuple[str, ...]
