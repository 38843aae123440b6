# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""All checks, in the order of the reference page."""

from __future__ import annotations

from smarttestudo.adirf.checks import (
    absent_from_bag,
    and_or_mixed,
    block_shadowed,
    blocks_clash,
    camera_info_off_grid,
    check_always_holds,
    check_never_holds,
    condition_always_holds,
    condition_never_holds,
    equals_measured,
    missing_default,
    no_margin,
    not_analysed,
    off_despite_floor,
    rate_below_floor,
    tf_without_tf_static,
    tier_without_rate,
    topic_twice,
    two_defaults,
    unknown_property,
    unnamed_in_profile,
)
from smarttestudo.adirf.checks.rule_check import RuleCheck

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
    unknown_property.CHECK,
    no_margin.CHECK,
    tf_without_tf_static.CHECK,
    camera_info_off_grid.CHECK,
    unnamed_in_profile.CHECK,
    absent_from_bag.CHECK,
    not_analysed.CHECK,
)
