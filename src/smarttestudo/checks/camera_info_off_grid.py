# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""camera_info at another rate than its image."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.checks.written import WrittenRate
from smarttestudo.domain.finding import ProfileFix, Severity
from smarttestudo.domain.rate import Rate

_CAMERA_INFO = "/camera_info"
_IMAGE_TYPES = frozenset({"sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"})


def _find(book: RuleModel) -> Iterator[Found]:
    for info in book.relayed:
        if info.endswith(_CAMERA_INFO) and book.context.topic(info).paced_with is None:
            images = [topic for topic in book.relayed if _is_image_of(info, topic, book)]
            yield from _first_difference(info, images, book)


def _is_image_of(info: str, topic: str, book: RuleModel) -> bool:
    camera = info.removesuffix(_CAMERA_INFO)
    if not topic.startswith(f"{camera}/") or topic == info:
        return False
    name = topic.removeprefix(f"{camera}/")
    return book.context.type_of(topic) in _IMAGE_TYPES or name.startswith("image")


def _first_difference(info: str, images: list[str], book: RuleModel) -> Iterator[Found]:
    for settings in ({}, *(branch.settings for branch in book.branches)):
        for image in images:
            here = _statement(image, settings, book) or _statement(info, settings, book)
            rates = _rate(info, settings, book), _rate(image, settings, book)
            if here is not None and None not in rates and rates[0] != rates[1]:
                yield _found(info, image, rates, here)
                return


def _statement(topic: str, settings: Mapping[str, WrittenRate], book: RuleModel) -> WrittenRate | None:
    return settings.get(topic) if settings else book.defaults.get(topic)


def _rate(topic: str, settings: Mapping[str, WrittenRate], book: RuleModel) -> Rate | None:
    setting = settings.get(topic) or book.defaults.get(topic)
    return Rate.full() if setting is None else setting.rate


def _found(info: str, image: str, rates: tuple[Rate | None, Rate | None], here: WrittenRate) -> Found:
    return Found(
        path=here.path,
        span=here.span,
        message=f"{info} is relayed at {rates[0]} and {image} at {rates[1]}: their stamps will not match",
        hint=f'set paced_with = "{image}" for {info} in the profile',
        profile_fix=ProfileFix(topic=info, key="paced_with", value=image, title=f"pace {info} with {image}"),
    )


CHECK = RuleCheck(
    code="camera-info-off-grid",
    severity=Severity.INFO,
    meaning="A camera_info has a different rate than its image.",
    why="RViz and image_proc pair an image with the camera_info of exactly the same stamp. Paced separately, "
    "they rarely have the same stamp, and no image is shown. paced_with lets the camera_info pass with its "
    "image.",
    bad=Example(
        rules="""\
begin
  SetFrequency /camera/image_raw 10
  SetFrequency /camera/camera_info 3
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /camera/image_raw 10
  SetFrequency /camera/camera_info 10
end
"""
    ),
    find=_find,
    needs_all_statements=True,
)
