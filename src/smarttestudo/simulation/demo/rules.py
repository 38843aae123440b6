# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The rules of a demo: its own, or those that the user edited after an earlier demo."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from smarttestudo.domain.errors import RuleFileError
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.rules.rule_files import read_rule_text
from smarttestudo.rules.rule_sets import check_texts

RULES = "warehouse.adirf"
WITHIN = "warehouse_within.adirf"
PREDICTED = "warehouse_predicted.adirf"


@dataclass(frozen=True, slots=True, kw_only=True)
class DemoRules:
    """Rules of the demo, called ``name``; ``are_edited`` where they are not the demo's own."""

    name: str
    text: str
    rule_set: RuleSet
    are_edited: bool


def put_rules(folder: Path, former: Path, name: str = RULES) -> DemoRules:
    """Put rules into a new demo's ``folder``: those of that ``name`` in ``former`` if the user edited them.

    Raises:
        RuleFileError: the edited rules cannot be read or have an error.
    """
    own = files("smarttestudo.simulation").joinpath(name).read_bytes()
    kept, path = former / name, folder / name
    are_edited = kept.is_file() and kept.read_bytes() != own
    if are_edited:
        shutil.copy(kept, path)
    else:
        path.write_bytes(own)
    text = read_rule_text(path)
    loaded = check_texts({name: text})
    for error in loaded.errors:
        place = f"{kept}:{error.span.line}:{error.span.column}"
        remedy = "fix it, or move the file away to use the demo's own rules"
        raise RuleFileError(error.message, place=place, remedy=remedy)
    return DemoRules(name=name, text=text, rule_set=loaded.rule_set, are_edited=are_edited)
