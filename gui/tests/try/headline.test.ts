// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type { WorstTopic } from "../../src/api/types";
import { errorWords, lossWords, missedWords } from "../../src/try/folder_result";

const worst = (topic: string, sent: number, received: number, longest_s: number, is_image = false): WorstTopic => ({
  ...{ topic, sent, received, longest_s, is_image },
  more_s: received === 0 ? null : longest_s,
});

test.each([
  [null, ""],
  [worst("/odom", 1000, 4, 131), "/odom: 4 of 1 000, up to 2.18 min old"],
  [worst("/odom", 1000, 0, 0), "/odom: none of 1 000"],
  [worst("/camera", 3360, 43, 2.9, true), "/camera: 43 of 3 360, dark for 2.9 s"],
])("the worst topic %o is said as %s", (worst_topic, words) => {
  expect(lossWords({ worst_topic })).toBe(words);
});

test("an error has its unit and its share of the range, and missed thresholds are counted", () => {
  const field = { topic: "/odom", field: "pose_y", unit: "m", rmse: 0.4, share: 0.05123 };
  expect(errorWords({ worst_field: field })).toBe("/odom pose_y: 0.4 m (5.12 %)");
  expect(errorWords({ worst_field: { ...field, unit: "" } })).toBe("/odom pose_y: 0.4 (5.12 %)");
  expect(errorWords({ worst_field: null })).toBe("");
  expect(missedWords({ crossings: 14, missed_crossings: 2 })).toBe("2 of 14");
  expect(missedWords({ crossings: 0, missed_crossings: 0 })).toBe("");
});
