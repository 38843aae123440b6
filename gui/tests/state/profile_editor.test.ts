// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from "vitest";
import { Api } from "../../src/api/client";
import type { FoundFile, ProfileRow } from "../../src/api/types";
import { ProfileEditor } from "../../src/state/profile_editor";
import { type Answers, type Disk, draftsIn, fileAnswers, serve } from "./served";

const FILE: FoundFile = { name: "lte.toml", kind: "profile", size_bytes: 1, changed_at_s: 1 };
const row = (topic: string, message_kb: number | null) => ({ topic, message_kb });
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

/** A table that is open, and kept as JSON by a server that answers `more` as well. */
async function openTable(disk: Disk, more: Answers = {}): Promise<ProfileEditor> {
  const written = (rows: ProfileRow[]) => rows.map(({ topic, message_kb }) => ({ topic, message_kb }));
  serve({
    ...fileAnswers("lte.toml", disk),
    "POST /api/profile/parse": ({ text = "" }) => ({ rows: JSON.parse(text), budget_kb_per_s: 100 }),
    "POST /api/profile/write": ({ rows }) => ({ text: JSON.stringify(written(rows as unknown as ProfileRow[])) }),
    "POST /api/profile/check": () => ({ problem: "" }),
    ...more,
  });
  const editor = new ProfileEditor(new Api(), "lte.toml", draftsIn());
  await editor.open([FILE]);
  return editor;
}

/** Types a message's size into a row. */
function type(editor: ProfileEditor, at: number, message_kb: string): void {
  const typed = editor.rows.value[at];
  if (!typed) throw new Error("the table has this row");
  editor.change(typed.key, { message_kb });
}

test("a table with a cell that is no number is not compared, so that nobody saves it without that cell", async () => {
  const disk = { text: JSON.stringify([row("/odom", 10)]) };
  const editor = await openTable(disk);
  type(editor, 0, "1,250");
  disk.text = JSON.stringify([row("/scan", 3)]);
  await editor.compare();
  expect([editor.conflict.value, editor.isSaved.value]).toEqual([null, false]);
  expect(editor.message.value).toContain("“1,250” can mean 1.25 or 1250");
});

test("numbers without a topic are a problem, and an empty row is none", async () => {
  const editor = await openTable({ text: JSON.stringify([row("/odom", 10)]) });
  editor.addRow();
  expect(editor.problems.value).toEqual([]);
  type(editor, 1, "12");
  expect(editor.problems.value).toEqual(["A row with numbers has no topic: name its topic, or remove it."]);
});

test("a save while another one is under way meets no conflict with oneself", async () => {
  const disk = { text: JSON.stringify([row("/odom", 10)]) };
  const { "PUT /api/file": put } = fileAnswers("lte.toml", disk);
  const arrived: (() => void)[] = [];
  const editor = await openTable(disk, {
    "PUT /api/file": (asked) => new Promise((resolve) => arrived.push(() => resolve(put?.(asked)))),
  });
  type(editor, 0, "11");
  const former = editor.save();
  await vi.waitUntil(() => arrived.length === 1);
  type(editor, 0, "112");
  const latter = editor.save();
  arrived[0]?.();
  await vi.waitUntil(() => arrived.length === 2);
  arrived[1]?.();
  await Promise.all([former, latter]);
  expect([editor.conflict.value, editor.isSaved.value, disk.text]).toEqual([
    null,
    true,
    JSON.stringify([row("/odom", 112)]),
  ]);
});

test("what was typed while the server was gone is checked when it is back", async () => {
  const editor = await openTable(
    { text: JSON.stringify([row("/odom", 10)]) },
    { "POST /api/profile/check": () => ({ problem: "the levels fall" }) },
  );
  vi.useFakeTimers();
  const { fetch } = globalThis;
  vi.stubGlobal("fetch", () => Promise.reject(new TypeError("Failed to fetch")));
  type(editor, 0, "11");
  await vi.runAllTimersAsync();
  expect(editor.problems.value).toEqual([]);
  vi.stubGlobal("fetch", fetch);
  await editor.revive();
  expect(editor.problems.value).toEqual(["the levels fall"]);
});
