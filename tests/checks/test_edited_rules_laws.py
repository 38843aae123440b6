# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules that are checked with what is known of other rules have the findings that they have by themselves."""

from __future__ import annotations

from random import Random

from hypothesis import given, settings
from hypothesis import strategies as st

from language.edited_texts import edited_texts
from smarttestudo.checks import CheckContext, CheckedRules, check_again, check_rules
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.language.parser import ParseResult, parse

TOPICS = ("/odom", "/scan", "/camera/image_raw", "/camera/camera_info", "/tf")
CONTEXTS = (
    CheckContext(),
    CheckContext(profile=Profile(path="p.toml", topics={"/odom": TopicProfile(source_hz=10.0)})),
    CheckContext(bag_topics={"/odom": "nav_msgs/msg/Odometry"}),
)


def block(random: Random) -> str:
    """A zone on a small floor, so that many overlap, touch or cover each other."""
    x, y = random.randrange(8), random.randrange(4)
    name = random.choice(("", f'Rule "Z{random.randrange(30)}"', f'Rule "P" Priority {random.randrange(3)}'))
    second = random.choice((f"/odom pose_y > {y}", f"/battery_state level < {10 * y}", "/odom pose_x > 7"))
    joined = random.choice(("AND", "AND", "AND", "OR"))
    checks = f"CheckValue /odom pose_x > {x} AND CheckValue /odom pose_x < {x + random.randrange(4)}"
    sets = [
        f"    SetFrequency {topic} {random.choice((1, 2, 4, 'Full', 'Off', 'Marginal'))}\n"
        for topic in random.sample(TOPICS, random.randrange(1, 3))
    ]
    broken = random.choice(("Then", "Then", "Then", "Then", "Then", "Then", "Then", "Than ("))
    otherwise = random.choice(("", "", "Else SetFrequency /odom 3\n", "Else KeepWithin /odom pose_x 0.5\n"))
    return f"{name}\nIf ({checks} {joined} CheckValue {second}) {broken}\n{''.join(sets)}{otherwise}EndIf\n"


def other(random: Random) -> str:
    topic = random.choice(TOPICS)
    return random.choice((f"SetFrequency {topic} {random.randrange(4)}\n", f"KeepAtLeast {topic} 2\n", "\n"))


def edited(parts: list[str], random: Random) -> list[str]:
    """One edit: another number, a block more or less, a line break more or less, or two at once."""
    at = random.randrange(len(parts))
    if random.random() < 0.3:
        breaks = [i for i, character in enumerate(parts[at]) if character == "\n"]
        place = random.choice([0, *breaks])
        is_longer = random.random() < 0.7 or place == 0
        changed = f"{parts[at][:place]}{chr(10) if is_longer else ' '}{parts[at][place + (not is_longer) :]}"
        return [*parts[:at], changed, *parts[at + 1 :]]
    digits = [i for i, character in enumerate(parts[at]) if character.isdigit()]
    kind = random.randrange(6)
    if kind <= 2 and digits:
        digit = random.choice(digits)
        changed = f"{parts[at][:digit]}{random.randrange(9)}{parts[at][digit + 1 :]}"
        return [*parts[:at], changed, *parts[at + 1 :]]
    if kind == 3:
        return [*parts[:at], *parts[at + 1 :]] or [block(random)]
    if kind == 4:
        return [*parts[:at], block(random), *parts[at:]]
    return [*parts[:at], block(random), *parts[at + 1 :]]


@given(st.integers(0, 2**32))
@settings(max_examples=250, deadline=None)
def test_edited_rules_have_the_findings_that_they_have_by_themselves(seed: int) -> None:
    random = Random(seed)
    parts = [random.choice((block, block, block, other))(random) for _ in range(random.randrange(1, 25))]
    context = random.choice(CONTEXTS)
    read = random.choice((None, parse("", "rules.adirf")))
    checked: CheckedRules | None = None
    for _ in range(random.randrange(2, 9)):
        text = f"begin\n{''.join(parts)}end\n"
        read = parse(text, "rules.adirf", read)
        checked = check_again([read], context, checked)
        assert list(checked.findings) == check_rules([parse(text, "rules.adirf")], context)
        parts = edited(parts, random)


@given(edited_texts(), st.sampled_from(CONTEXTS))
@settings(max_examples=150, deadline=None)
def test_any_edited_text_has_the_findings_that_it_has_by_itself(
    texts: list[str], context: CheckContext
) -> None:
    read: ParseResult | None = None
    checked: CheckedRules | None = None
    for text in texts:
        read = parse(text, "rules.adirf", read)
        checked = check_again([read], context, checked)
        assert list(checked.findings) == check_rules([parse(text, "rules.adirf")], context)
