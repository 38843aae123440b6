// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type { FoundFile } from "../../src/api/types";
import { changedSince, foldersIn, recordingFor, recordingsIn, Tries } from "../../src/state/tries";

const RULES = { text: "begin end", name: "runs/monday.adirf", profile_text: "# Measured" };
const bag = (size_bytes: number, changed_at_s = 1): FoundFile => ({ name: "b", kind: "bag", size_bytes, changed_at_s });
const TRY = { tried: RULES, recordings: [bag(5)] };

test("the tries of a file are its own, whoever asks", () => {
  const tries = new Tries(() => undefined);
  expect(tries.of("a")).toBe(tries.of("a"));
  expect(tries.of("a")).not.toBe(tries.of("b"));
});

test.each([
  [RULES, [bag(5)], []],
  [{ ...RULES, text: "begin" }, [bag(5)], ["rules"]],
  [{ ...RULES, profile_text: null }, [bag(6)], ["profile", "recording"]],
  [RULES, [bag(5, 2)], ["recording"]],
  [RULES, [], ["recording"]],
  [RULES, [{ ...bag(5), name: "c" }], ["recording"]],
  [RULES, [bag(5), { ...bag(5), name: "c" }], ["recording"]],
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

test("folders with two recordings below them are offered, all recordings first", () => {
  const named = (name: string): FoundFile => ({ ...bag(1), name });
  const files = [...["-x/a", "-x/b", "home", "runs/a/1", "runs/a/2", "runs/b/1", "one/1"].map(named)];
  const rules: FoundFile = { ...named("one/rules.adirf"), kind: "rules" };
  expect(foldersIn([...files, rules])).toEqual([
    ["/", 7],
    ["-x/", 2],
    ["runs/", 3],
    ["runs/a/", 2],
  ]);
  expect(recordingsIn("runs/a/", files).map(({ name }) => name)).toEqual(["runs/a/1", "runs/a/2"]);
  expect(recordingsIn("/", [...files, rules])).toEqual(files);
  expect(foldersIn([named("alone"), rules])).toEqual([]);
  expect(foldersIn([named("runs/alone"), rules], "runs/")).toEqual([["runs/", 1]]);
  expect(foldersIn([named("alone")], "gone/")).toEqual([["gone/", 0]]);
  expect(foldersIn([named("alone")], "/")).toEqual([["/", 1]]);
});
