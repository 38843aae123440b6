// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type { CheckCondition, IncidentRecord, Missing, Operator } from "../../src/api/types";
import {
  briefly,
  furtherWords,
  missingWords,
  sinceMoment,
  sinceTrigger,
  valueWords,
  windowWords,
} from "../../src/incidents/missing_words";
import { sizeWords } from "../../src/ui/numbers";

/** A stamp as the page has it, of so many seconds from the moment. */
const stampNs = (seconds: number) => Number(1_700_000_000_123_456_789n + BigInt(Math.round(seconds * 1e9)));
const TRIGGERED_NS = stampNs(0);

function gap(topic: string, messages: number | null, reason: Missing["reason"] = "ended"): Missing {
  return { topic, reason, messages, from_ns: stampNs(-5), to_ns: stampNs(0.04) };
}

test.each([
  [-3.24, "3.2 s before"],
  [0, "the moment"],
  [-0.04, "the moment"],
  [60, "60.0 s after"],
])("%j s from the moment is %j", (seconds, words) => {
  expect(sinceMoment(seconds)).toBe(words);
});

test.each([
  [0.013, "13 B"],
  [290.4, "290 KB"],
  [1234, "1.23 MB"],
  [5_000_000, "5 GB"],
])("%j KB are %j", (kb, words) => {
  expect(sizeWords(kb)).toBe(words);
});

test("a stamp of the clock, which the page rounds, is said as exactly as a short one", () => {
  const long = (seconds: number) => sinceTrigger(stampNs(seconds), TRIGGERED_NS);
  for (const seconds of [-3.25, -0.05, 0.15, 0.25, 60.75]) expect(long(seconds)).toBe(sinceMoment(seconds));
  const stamps = { from_ns: stampNs(-3), triggered_ns: TRIGGERED_NS, to_ns: stampNs(2.5) };
  expect(windowWords(stamps)).toBe("3 s before to 2.5 s after");
});

test("counted messages are said topic by topic", () => {
  expect(missingWords([gap("/scan", 1, "memory"), gap("/image", 1200, "memory")], TRIGGERED_NS)).toEqual([
    "1 message of /scan, from 5.0 s before to the moment: the memory for what came before was full",
    "1 200 messages of /image, from 5.0 s before to the moment: the memory for what came before was full",
  ]);
});

test("topics that nobody heard at the same time, for the same reason, share a line", () => {
  expect(missingWords([gap("/scan", null), gap("/odom", null), gap("/tf", null, "late")], TRIGGERED_NS)).toEqual([
    "whatever came on /scan, /odom, from 5.0 s before to the moment: the run, or the recording, ended",
    "whatever came on /tf, from 5.0 s before to the moment: nothing was received from the topic yet",
  ]);
});

test("a list has the reasons only", () => {
  expect(briefly(["memory", "ended"])).toBe("memory was short, ended early");
  expect(briefly([])).toBe("");
  expect(briefly(["ended", "of a later version", "ended"])).toBe("ended early");
  expect(briefly(["of a later version"])).toBe("something");
});

test("each further moment is said with what its condition read, and how many are not listed", () => {
  const record: IncidentRecord = {
    ...{ name: "near miss", rule: "Close call", file: "rules.adirf", line: 3, rules_sha256: "", topics: {} },
    ...{ triggered_ns: TRIGGERED_NS, from_ns: stampNs(-3), to_ns: stampNs(9), latched: [], missing: [] },
    values: { "/scan distance": 0.4 },
    moments: 4,
    further_moments: [
      { time: "", triggered_ns: stampNs(1.5), values: { "/scan distance": 0.41, "/odom speed": null } },
      { time: "", triggered_ns: stampNs(7), values: {} },
    ],
  };
  expect(furtherWords(record, { "/scan distance": "m" })).toEqual([
    "1.5 s after: /scan distance was 0.41 m, /odom speed was unknown or infinite",
    "7.0 s after",
    "and 1 time more",
  ]);
  const { moments, further_moments, ...alone } = record;
  expect(furtherWords(alone, {})).toEqual([]);
});

test("a value is said beside what the rule compares it with", () => {
  const check = (topic: string, property: string, op: Operator, value: number | string): CheckCondition => {
    return { kind: "check", topic, property, op, value };
  };
  const checks = [
    check("/scan", "distance", "<", 0.9),
    check("/odom", "pose_y", ">", 1),
    check("/odom", "pose_y", "<", 5.4),
    check("mode", "data", "=", '"docking"'),
  ];
  const values = { "/scan distance": 0.885, "/odom pose_y": 6, "/ada/mode data": "docking", "/imu yaw": null };
  expect(valueWords(values, { "/scan distance": "m", "/odom pose_y": "m" }, checks)).toEqual([
    "/scan distance was 0.885 m, below 0.9 m",
    "/odom pose_y was 6 m, above 1 m and not below 5.4 m",
    "/ada/mode data was “docking”, equal to “docking”",
    "/imu yaw was unknown or infinite",
  ]);
});
