// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from "vitest";
import { openRules } from "./served";

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

/** What the page says of a text of so many rates, once the server has read it. */
async function saidOf(count: number): Promise<string> {
  const statements = Array.from({ length: count }, (_, at) => ({ kind: "set", id: `s${at}`, key: `${at}` }));
  const collections = [{ id: "c1", statements }];
  const editor = await openRules(
    { text: "begin\nend\n" },
    { "POST /api/document": () => ({ collections, findings: [], parses: true }) },
  );
  await editor.check();
  return editor.tooLong.value;
}

test("a text of more than 1000 blocks is said to be slow here", async () => {
  expect(await saidOf(1000)).toBe("");
  expect(await saidOf(1204)).toContain("1 204 blocks in one file");
});

test("the whole text is read once after a pause in typing", async () => {
  const read: string[] = [];
  const editor = await openRules(
    { text: "begin\nend\n" },
    {
      "POST /api/document": ({ text = "" }) => {
        read.push(text);
        return { collections: [], findings: [], parses: true };
      },
    },
  );
  await editor.check();
  vi.useFakeTimers();
  read.length = 0;
  for (const letters of ["/", "//", "// a"]) {
    editor.type(`begin\n${letters}\nend\n`);
    await vi.advanceTimersByTimeAsync(200);
  }
  expect(read).toEqual([]);
  await vi.advanceTimersByTimeAsync(200);
  expect(read).toEqual(["begin\n// a\nend\n"]);
});
