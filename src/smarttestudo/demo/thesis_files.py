# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The names of the files with the thesis's tables and figures."""

from __future__ import annotations

from collections.abc import Mapping

from smarttestudo.simulation.readings import Topic

FOLDER = "thesis"
FREQUENCY_TABLE = "table-7.1-frequency"
BANDWIDTH_TABLE = "table-7.2-bandwidth"
ZONES_FIGURE = "zones.png"


def figure_names() -> Mapping[str, str]:
    """The file of each figure: of a topic's rate by the topic, of the zones by an empty name.

    The static frames are no topic of the thesis.
    """
    topics = (topic.value for topic in Topic if topic is not Topic.TF_STATIC)
    of_topics = {topic: f"frequency{topic.replace('/', '-')}.png" for topic in topics}
    return {**of_topics, "": ZONES_FIGURE}


def file_names() -> frozenset[str]:
    """All that a demo may write into the folder."""
    tables = (f"{name}.{form}" for name in (FREQUENCY_TABLE, BANDWIDTH_TABLE) for form in ("md", "csv"))
    return frozenset({*tables, *figure_names().values()})
