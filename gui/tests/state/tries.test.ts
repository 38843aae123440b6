// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type { FoundFile } from "../../src/api/types";
import { changedSince, recordingFor, Tries } from "../../src/state/tries";

const RULES = { text: "begin end", name: "runs/monday.adirf", profile_text: "# Measured" };
const bag = (size_bytes: number, changed_at_s = 1): FoundFile => ({ name: "b", kind: "bag", size_bytes, changed_at_s });
const TRY = { tried: RULES, bag: "b", recording: bag(5) };

test("the tries of a file are its own, whoever asks", () => {
  const tries = new Tries();
  expect(tries.of("a")).toBe(tries.of("a"));
  expect(tries.of("a")).not.toBe(tries.of("b"));
});

test.each([
  [RULES, [bag(5)], []],
  [{ ...RULES, text: "begin" }, [bag(5)], ["rules"]],
  [{ ...RULES, profile_text: null }, [bag(6)], ["profile", "recording"]],
  [RULES, [bag(5, 2)], ["recording"]],
  [RULES, [], ["recording"]],
])("a try says what changed since: %o %o", (rules, files, changed) => {
  expect(changedSince(TRY, rules, files)).toEqual(changed);
});

const BAGS = ["longest", "on_map", "runs/measured.mcap", "runs/monday"];
const measured = "# Measured by testudo profile in runs/measured.mcap: 12.0 s, 3 topics,\n";
test.each([
  [{ ...RULES, profile_text: measured }, "on_map", "on_map"],
  [{ ...RULES, profile_text: measured }, null, "runs/measured.mcap"],
  [{ ...RULES, profile_text: measured.replace("measured.mcap", "gone") }, "gone", "runs/monday"],
  [{ ...RULES, name: "other.adirf", profile_text: null }, null, "longest"],
])("a try of %o with the path of %s starts with %s", (rules, drawn, name) => {
  expect(recordingFor(BAGS, rules, drawn)).toBe(name);
});
