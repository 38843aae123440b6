# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Zones as JSON, and back."""

from __future__ import annotations

import math

from smarttestudo.adirf.checks.wording import check_text
from smarttestudo.adirf.document import Document, EditError
from smarttestudo.adirf.zones import PolygonError, ZoneRectangle, covering_rectangles
from smarttestudo.adirf.zones.cover import MAX_RECTANGLES
from smarttestudo.composition.ruler import zones
from smarttestudo.composition.ruler.checked_text import CheckedText
from smarttestudo.web import zone_schemas as schema

_FAR_M = 1e6
_CM_PER_M = 100
_CM2_PER_M2 = 10_000


def zones_answer(checked: CheckedText) -> schema.ZonesAnswer:
    """The zones of a text, and which clash."""
    rules = zones.rule_zones_of(checked.document)
    return schema.ZonesAnswer(
        rules=tuple(map(_rule, rules)),
        clashes=tuple(
            schema.ZoneClashModel(
                first=clash.first,
                second=clash.second,
                message=clash.message,
                hint=clash.hint,
                common=tuple(map(_model, clash.common)),
            )
            for clash in zones.zone_clashes(checked, rules)
        ),
        label=zones.unused_label(checked.document),
    )


def zone_edited(document: Document, change: schema.NewZone | schema.MoveZone | schema.ResizeZone) -> str:
    """The text with one zone edited. Raises ``EditError`` for what no rule can say."""
    match change:
        case schema.NewZone():
            rectangles = [_rectangle(one) for one in change.rectangles[: MAX_RECTANGLES + 1]]
            if len(rectangles) > MAX_RECTANGLES:
                raise EditError(f"a zone has at most {MAX_RECTANGLES} rectangles", remedy="draw it simpler")
            return zones.with_new_zone(
                document, change.topic, rectangles, into=change.into, label=change.label
            )
        case schema.MoveZone():
            by_m = (_known(change.dx), _known(change.dy))
            return zones.with_moved_zone(document, change.id, change.topic, by_m)
        case schema.ResizeZone():
            return zones.with_resized_zone(document, change.id, change.index, _rectangle(change.rectangle))


def cover(request: schema.CoverRequest) -> schema.CoverAnswer:
    """The rectangles for a polygon; its corners are rounded to centimetres."""
    if not 1 <= request.max_rectangles <= MAX_RECTANGLES:
        raise PolygonError(f"the rectangles must be 1 to {MAX_RECTANGLES}", remedy="give another number")
    corners = [(round(_known(x) * _CM_PER_M), round(_known(y) * _CM_PER_M)) for x, y in request.corners]
    found = covering_rectangles(corners, max_rectangles=request.max_rectangles)
    return schema.CoverAnswer(
        rectangles=tuple(
            schema.RectangleModel(
                min_x=one.min_x_cm / _CM_PER_M,
                max_x=one.max_x_cm / _CM_PER_M,
                min_y=one.min_y_cm / _CM_PER_M,
                max_y=one.max_y_cm / _CM_PER_M,
            )
            for one in found.rectangles
        ),
        polygon_m2=found.polygon_cm2 / _CM2_PER_M2,
        over_m2=found.over_cm2 / _CM2_PER_M2,
    )


def _rule(rule: zones.RuleZones) -> schema.RuleZonesModel:
    reading = rule.reading
    return schema.RuleZonesModel(
        id=rule.id,
        label=rule.block.label,
        zones=tuple(
            schema.ZoneModel(topic=one.topic, rectangle=_model(one.rectangle), is_shared=rule.is_shared(one))
            for one in reading.zones
        ),
        others=tuple(map(check_text, reading.others)),
        holds_elsewhere=reading.holds_elsewhere,
        is_too_mixed=reading.is_too_mixed,
    )


def _model(one: ZoneRectangle) -> schema.RectangleModel:
    return schema.RectangleModel(min_x=one.min_x_m, max_x=one.max_x_m, min_y=one.min_y_m, max_y=one.max_y_m)


def _rectangle(model: schema.RectangleModel) -> ZoneRectangle:
    return ZoneRectangle(
        min_x_m=_bounded(model.min_x),
        max_x_m=_bounded(model.max_x),
        min_y_m=_bounded(model.min_y),
        max_y_m=_bounded(model.max_y),
    )


def _bounded(metres: float | None) -> float | None:
    return None if metres is None else _known(metres)


def _known(metres: float) -> float:
    if not math.isfinite(metres) or abs(metres) > _FAR_M:
        raise EditError(f"{metres} m is no place on a map", remedy="give metres, below a million")
    return metres
