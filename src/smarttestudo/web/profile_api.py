# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page asks about topics: their table, sizes measured in a bag, and words to suggest."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from smarttestudo.adapters.files.profile import parse_profile
from smarttestudo.adapters.files.project_folder import ProjectFolder
from smarttestudo.adirf.parser import parse
from smarttestudo.adirf.properties import ARRIVAL_PROPERTIES, PropertySpec, known_types, properties_of
from smarttestudo.adirf.syntax import Operator
from smarttestudo.composition.ruler import profile_table
from smarttestudo.composition.ruler.vocabulary import known_topics, topics_of_bag
from smarttestudo.domain.errors import ProfileError
from smarttestudo.domain.rate import MAX_RATE_HZ
from smarttestudo.domain.tier import Tier
from smarttestudo.optimizer.profiling.text import proposed_tiers_hz
from smarttestudo.web import schemas as schema
from smarttestudo.web.curve_schemas import LevelsAnswer, LevelsRequest, ProfileCheckAnswer


class ProfileApi:
    """Profiles and words, with the bags of ``folder``; ``robot_topics`` are the types of what is live now."""

    def __init__(self, folder: ProjectFolder, robot_topics: Callable[[], Mapping[str, str]]) -> None:
        self._folder = folder
        self._robot_topics = robot_topics

    def parse(self, request: schema.ProfileParseRequest) -> schema.ProfileTable:
        """A profile as a table."""
        table = profile_table.read_table(request.text, Path(request.name))
        return schema.ProfileTable(
            rows=tuple(
                schema.ProfileRow(
                    topic=row.topic,
                    type=row.type_name,
                    message_kb=row.message_kb,
                    source_hz=row.source_hz,
                    tiers_hz=None if row.tiers_hz is None else _six(row.tiers_hz),
                    priority=row.priority,
                    min_hz=row.min_hz,
                    max_hz=row.max_hz,
                )
                for row in table.rows
            ),
            budget_kb_per_s=table.budget_kb_per_s,
        )

    def write(self, request: schema.ProfileWriteRequest) -> schema.TextAnswer:
        """A table as a profile."""
        table = profile_table.ProfileTable(
            rows=tuple(
                profile_table.TableRow(
                    topic=row.topic,
                    type_name=row.type,
                    message_kb=row.message_kb,
                    source_hz=row.source_hz,
                    tiers_hz=row.tiers_hz,
                    priority=row.priority,
                    min_hz=row.min_hz,
                    max_hz=row.max_hz,
                )
                for row in request.rows
            ),
            budget_kb_per_s=request.budget_kb_per_s,
        )
        return schema.TextAnswer(text=profile_table.write_table(table, request.base_text, Path(request.name)))

    def check(self, request: schema.ProfileWriteRequest) -> ProfileCheckAnswer:
        """Whether ``write`` would do it, for a table that is being typed."""
        try:
            self.write(request)
        except ProfileError as error:
            return ProfileCheckAnswer(problem=error.cause)
        return ProfileCheckAnswer(problem="")

    def measure(self, request: schema.ProfileMeasureRequest) -> schema.TextAnswer:
        """A profile measured in a bag."""
        from smarttestudo.composition.ruler.measuring import measured_profile  # noqa: PLC0415  reads bags

        return schema.TextAnswer(text=measured_profile(self._folder.bag(request.bag), request.bag))

    def vocabulary(self, request: schema.VocabularyRequest) -> schema.VocabularyAnswer:
        """Words to suggest."""
        topics = known_topics(
            profile=None
            if request.profile_text is None
            else parse_profile(request.profile_text, Path("profile.toml")),
            bag_topics={} if request.bag is None else topics_of_bag(self._folder.bag(request.bag)),
            rules=None if request.text is None else parse(request.text, "the rules"),
            robot_topics=self._robot_topics(),
        )
        return schema.VocabularyAnswer(
            topics=tuple(
                schema.VocabularyTopic(
                    topic=one.topic,
                    type=one.type_name,
                    properties=_models(properties_of(one.type_name or "").values()),
                    source=one.source.value,
                )
                for one in topics
            ),
            every_topic=_models(ARRIVAL_PROPERTIES.values()),
            by_type={name: _models(properties_of(name).values()) for name in known_types()},
            tiers=tuple(tier.value for tier in Tier),
            operators=tuple(operator.value for operator in Operator),
        )

    def vocabulary_of_files(self, profile: str | None, bag: str | None) -> schema.VocabularyAnswer:
        """Words to suggest, from files of the project."""
        text = None if profile is None else self._folder.read(profile).text
        return self.vocabulary(schema.VocabularyRequest(profile_text=text, bag=bag))


def levels_of_rate(request: LevelsRequest) -> LevelsAnswer:
    """Six levels to begin with, where nothing but the rate of the source is known."""
    if not 0 < request.source_hz <= MAX_RATE_HZ:
        raise ProfileError(
            f"a source of {request.source_hz:g} Hz has no levels",
            remedy=f"give a rate above 0, up to {MAX_RATE_HZ:g} Hz",
        )
    return LevelsAnswer(tiers_hz=_six(proposed_tiers_hz(request.source_hz)))


def _models(specs: Iterable[PropertySpec]) -> tuple[schema.PropertyModel, ...]:
    return tuple(
        schema.PropertyModel(
            name=spec.name,
            unit=spec.unit,
            meaning=spec.meaning,
            minimum=spec.minimum,
            maximum=spec.maximum,
        )
        for spec in specs
    )


def _six(tiers_hz: tuple[float, ...]) -> tuple[float, float, float, float, float, float]:
    one, two, three, four, five, six = tiers_hz
    return one, two, three, four, five, six
