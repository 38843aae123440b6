# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""All checks of rule files, and running them."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.checks import (
    absent_from_bag,
    and_or_mixed,
    block_disabled,
    block_shadowed,
    blocks_clash,
    bound_despite_off,
    bound_in_rules_only,
    bound_on_follower,
    bound_twice,
    camera_info_off_grid,
    check_always_holds,
    check_never_holds,
    condition_always_holds,
    condition_never_holds,
    duration_too_short,
    duration_zero,
    equals_measured,
    missing_blank,
    missing_default,
    no_margin,
    not_analysed,
    off_despite_floor,
    rate_below_floor,
    rate_without_effect,
    record_too_large,
    record_unpublished,
    tf_without_tf_static,
    tier_without_rate,
    topic_twice,
    two_defaults,
    unknown_bound,
    unknown_property,
    unnamed_in_profile,
    until_never_ends,
    until_overlaps,
)
from smarttestudo.checks.context import CheckContext
from smarttestudo.checks.rule_check import RuleCheck
from smarttestudo.checks.rule_model import read_rule_model
from smarttestudo.domain.finding import Finding
from smarttestudo.language.parser.rule_file import ParseResult

CHECKS: tuple[RuleCheck, ...] = (
    topic_twice.CHECK,
    tier_without_rate.CHECK,
    blocks_clash.CHECK,
    block_shadowed.CHECK,
    check_never_holds.CHECK,
    check_always_holds.CHECK,
    condition_never_holds.CHECK,
    condition_always_holds.CHECK,
    two_defaults.CHECK,
    missing_default.CHECK,
    rate_below_floor.CHECK,
    off_despite_floor.CHECK,
    and_or_mixed.CHECK,
    equals_measured.CHECK,
    duration_zero.CHECK,
    duration_too_short.CHECK,
    until_overlaps.CHECK,
    until_never_ends.CHECK,
    unknown_property.CHECK,
    unknown_bound.CHECK,
    bound_in_rules_only.CHECK,
    bound_despite_off.CHECK,
    bound_twice.CHECK,
    bound_on_follower.CHECK,
    record_too_large.CHECK,
    record_unpublished.CHECK,
    no_margin.CHECK,
    rate_without_effect.CHECK,
    tf_without_tf_static.CHECK,
    camera_info_off_grid.CHECK,
    unnamed_in_profile.CHECK,
    absent_from_bag.CHECK,
    missing_blank.CHECK,
    block_disabled.CHECK,
    not_analysed.CHECK,
)


def check_rules(results: Sequence[ParseResult], context: CheckContext) -> list[Finding]:
    """Everything to say about the parsed files of one set, errors of syntax included, by place.

    Bounded in time and memory for any files.
    """
    book = read_rule_model([result.file for result in results], context)
    is_whole = context.has_all_files and all(result.is_valid for result in results)
    findings = [finding for result in results for finding in result.findings]
    for check in CHECKS:
        if is_whole or not check.needs_all_statements:
            findings.extend(check.findings(book))
    return sorted(findings, key=lambda one: (one.path, one.span.line, one.span.column))
