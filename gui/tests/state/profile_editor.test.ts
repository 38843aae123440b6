// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from "vitest";
import { type Disk, openTable, typeSize } from "./served";

const row = (topic: string, message_kb: number | null) => ({ topic, message_kb });
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

test("a table with a cell that is no number is compared as it was typed, and kept without being saved", async () => {
  const disk: Disk = { text: JSON.stringify([row("/odom", 10)]) };
  const editor = await openTable(disk);
  typeSize(editor, 0, "1,250");
  disk.text = JSON.stringify([row("/scan", 3)]);
  await editor.compare();
  expect(editor.conflict.value?.mine).toContain("/odom  1,250");
  await editor.keepMine();
  expect([editor.conflict.value, editor.isSaved.value, disk.draft?.content.includes("1,250")]).toEqual([
    null,
    false,
    true,
  ]);
  expect(disk.text).toBe(JSON.stringify([row("/scan", 3)]));
});

test("numbers without a topic are a problem, and an empty row is none", async () => {
  const editor = await openTable({ text: JSON.stringify([row("/odom", 10)]) });
  editor.addRow();
  expect(editor.problems.value).toEqual([]);
  typeSize(editor, 1, "12");
  expect(editor.problems.value).toEqual(["A row with numbers has no topic: name its topic, or remove it."]);
});

test("what was typed while the server was gone is checked when it is back", async () => {
  const editor = await openTable(
    { text: JSON.stringify([row("/odom", 10)]) },
    { "POST /api/profile/check": () => ({ problem: "the levels fall" }) },
  );
  vi.useFakeTimers();
  const { fetch } = globalThis;
  vi.stubGlobal("fetch", () => Promise.reject(new TypeError("Failed to fetch")));
  typeSize(editor, 0, "11");
  await vi.runAllTimersAsync();
  expect(editor.problems.value).toEqual([]);
  vi.stubGlobal("fetch", fetch);
  await editor.revive();
  expect(editor.problems.value).toEqual(["the levels fall."]);
});

test("a table that was made for rules is theirs, also where it was gone and is saved again", async () => {
  const chosen: unknown[] = [];
  const disk: Disk = { text: "[]" };
  const editor = await openTable(disk, { "PUT /api/profile/for": (asked) => void chosen.push(asked) });
  editor.madeFor.value = "a.adirf";
  editor.setBudget("200");
  await editor.save();
  expect(chosen).toEqual([]);
  editor.setBudget("300");
  disk.text = null;
  await editor.save();
  await editor.keepMine();
  expect(chosen).toEqual([{ name: "a.adirf", profile: "lte.toml" }]);
});

test("a table that was made for rules is still theirs when it is saved after a reload", async () => {
  vi.useFakeTimers();
  const disk: Disk = { text: null };
  const before = await openTable(disk);
  before.madeFor.value = "a.adirf";
  before.setBudget("200");
  await vi.runAllTimersAsync();
  const chosen: unknown[] = [];
  const more = { "PUT /api/profile/for": (asked: unknown) => void chosen.push(asked) };
  const after = await openTable(disk, more);
  expect(after.budget.value).toBe("200");
  await after.save();
  expect(chosen).toEqual([{ name: "a.adirf", profile: "lte.toml" }]);
});
