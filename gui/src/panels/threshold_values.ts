// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Api } from "../api/client";
import type { FoundFile } from "../api/types";
import { toCondition } from "../blocks/conditions";
import type { DrawValues } from "../blocks/number_field";
import type { RuleEditor } from "../state/rule_editor";
import { bagsIn, type FileTries, fileOf, recordingOf } from "../state/tries";
import { checkIn } from "../state/written_checks";

/** Draws the values of a check in the recording of its rules; nothing in a project without recordings. */
export function valuesOfRecording(
  api: Api,
  editor: RuleEditor,
  tries: FileTries,
  files: () => readonly FoundFile[],
): DrawValues {
  return (host, block, threshold) => {
    const bag = recordingOf(bagsIn(files()), tries, editor.rules, editor.map.peek().bag);
    const recording = fileOf(bag, files());
    const condition = toCondition(block);
    const check = condition && checkIn(condition);
    if (recording === undefined || !condition || !check) return null;
    const asked = { bag, check, condition, profileText: editor.profile.peek()?.text ?? null };
    let isLeft = false;
    let close: (() => void) | null = null;
    void import("../try/check_courses").then(({ drawPicked }) => {
      if (!isLeft) close = drawPicked(host, { api, asked, sizeBytes: recording.size_bytes, threshold });
    });
    return () => {
      isLeft = true;
      close?.();
    };
  };
}
