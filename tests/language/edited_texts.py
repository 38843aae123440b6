# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Hypothesis strategies of a rule file's text through many edits, errors of syntax included."""

from __future__ import annotations

from functools import cache

from hypothesis import strategies as st

from language.written_rules import written_files

LINES = (
    "begin",
    "end",
    "EndIf",
    "    EndIf // done",
    "",
    "// a comment",
    "# a comment of another language",
    "SetFrequency /odom 5",
    "KeepAtLeast /odom 1",
    "KeepWithin /odom pose_x 0.5",
    "If (CheckValue /odom pose_x > 1) Then",
    'Rule "Near" Priority 2',
    "If (CheckValue /odom pose_x < 1 AND CheckValue /scan rate > 3) Then SetFrequency /scan 2",
    "Else SetFrequency /odom Full",
    "CheckValue /odom",
    "> 3",
    "Disabled",
    "Disabeld Rul If",
    "IfThenSetFrequency/odom 3EndIf",
    ")",
    'Rule "Open',
)
LINE_BREAKS = ("\n", "\r\n", "\r", "\n\n")
BLOCKS = (
    "If (CheckValue /odom pose_x > 1) Then\n    SetFrequency /odom 5\nEndIf\n",
    'Rule "Far"\nIf (CheckValue /odom pose_x > 2) Then\nSetFrequency /odom 7\n'
    "Else\nSetFrequency /scan 7\nEndIf\n",
    '// Here\nDisabled Rule "Off" If (CheckValue /scan rate > 2) Then SetFrequency /odom 7\n  EndIf // b\n\n',
    "If (CheckValue /odom x > 1) Then SetFrequency\n/odom 5 SetFrequency /odom 5\nEndIf\n",
    "If (CheckValue /odom\nEndIf\n> 2) Then SetFrequency /odom 5\n EndIf \r\n",
)


@cache
def pieces() -> st.SearchStrategy[str]:
    """A line or block of a rule file, whole or not."""
    return st.one_of(
        st.sampled_from(BLOCKS),
        st.sampled_from(LINES).map(lambda line: f"{line}\n"),
        st.sampled_from(LINES),
        st.text(alphabet='EndIf \n\r/"()>#x1', max_size=4),
    )


@cache
@st.composite
def edited_texts(draw: st.DrawFn, *, max_edits: int = 6) -> list[str]:
    """A text, mostly behind an empty one, and that text after each of some edits; many move its lines."""
    if draw(st.booleans()):
        text = draw(written_files(max_statements=4)).text
    else:
        text = "begin\n{}end\n".format("".join(draw(st.lists(pieces(), max_size=8))))
    if draw(st.integers(0, 7)) == 0:
        text = f"\ufeff{text}"
    texts = draw(st.sampled_from(([text], ["", text], ["", text])))
    for _ in range(draw(st.integers(1, max_edits))):
        starts = [at + 1 for at, character in enumerate(text) if character == "\n"] or [0]
        start = draw(st.sampled_from(starts) | st.integers(0, len(text)))
        end = draw(st.just(start) | st.integers(start, min(len(text), start + 40)))
        written = draw(pieces() | st.sampled_from(LINE_BREAKS) | st.just(""))
        text = text[:start] + written + text[end:]
        texts.append(text)
    return texts
