// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { signal } from "@preact/signals";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { type Draft, Drafts, NO_ROOM, type Restored, storeDraft } from "../../src/state/drafts";

let leave = () => {};

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal("addEventListener", (_: string, act: () => void) => (leave = act));
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

/** A file that is typed into, and what the browser wrote of it. */
function typedFile(isFull = false) {
  const written: string[] = [];
  const entries = new Map<string, string>();
  const storage = {
    length: 0,
    key: () => null,
    getItem: () => null,
    removeItem: (key: string) => void entries.delete(key),
    setItem: (key: string, value: string) => {
      if (isFull) throw new Error("QuotaExceededError");
      written.push((JSON.parse(value) as Draft).content);
      entries.set(key, value);
    },
  };
  const [text, message, restored] = [signal(""), signal(""), signal<Restored | null>(null)];
  const draft = () => {
    const content = text.value;
    return content === "" ? null : () => ({ content, hash: null, changedMs: 0 });
  };
  storeDraft(new Drafts(storage, "shelf", "tab", async () => new Set()), "rules", {
    name: "a.adirf",
    restored,
    message,
    draft,
  });
  return { text, message, written, entries };
}

test("a draft is written once for the letters of a moment, with the last of them", () => {
  const { text, written } = typedFile();
  for (const typed of ["a", "ab", "abc"]) text.value = typed;
  expect(written).toEqual([]);
  vi.runAllTimers();
  text.value = "abcd";
  vi.runAllTimers();
  expect(written).toEqual(["abc", "abcd"]);
});

test("a page that is left keeps the last letter", () => {
  const { text, written } = typedFile();
  text.value = "a";
  leave();
  vi.runAllTimers();
  expect(written).toEqual(["a"]);
});

test("a draft that was saved meanwhile is not written, and the one before is gone", () => {
  const { text, written, entries } = typedFile();
  text.value = "a";
  vi.runAllTimers();
  text.value = "ab";
  text.value = "";
  vi.runAllTimers();
  expect([written, entries.size]).toEqual([["a"], 0]);
});

test("a browser without room says that what is not saved would be lost", () => {
  const { text, message } = typedFile(true);
  text.value = "a";
  vi.runAllTimers();
  expect(message.value).toBe(NO_ROOM);
});
