// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { type DraftStorage, Drafts } from "../../src/state/drafts";

/** A browser's storage that holds so many letters. */
function storageOf(roomLetters = 10_000): DraftStorage & { entries: Map<string, string> } {
  const entries = new Map<string, string>();
  return {
    entries,
    get length() {
      return entries.size;
    },
    key: (index) => [...entries.keys()][index] ?? null,
    getItem: (key) => entries.get(key) ?? null,
    removeItem: (key) => void entries.delete(key),
    setItem: (key, value) => {
      if (value.length > roomLetters) throw new Error("QuotaExceededError");
      entries.set(key, value);
    },
  };
}

const draftsOf = (storage: DraftStorage, tab: string, others: string[] = [], project = "shelf") =>
  new Drafts(storage, project, tab, async () => new Set(others));
const draft = (content: string, changedMs = 1) => ({ content, hash: "a", changedMs });

test("the next tab goes on with the draft of one that is gone", async () => {
  const storage = storageOf();
  draftsOf(storage, "one").keep("rules", "a.adirf", draft("typed"));
  const two = draftsOf(storage, "two");
  expect(await two.takeOver("rules", "a.adirf")).toEqual(draft("typed"));
  two.drop("rules", "a.adirf");
  expect(storage.entries.size).toBe(0);
});

test("two tabs do not take each other's draft, and write beside each other", async () => {
  const storage = storageOf();
  const one = draftsOf(storage, "one", ["two"]);
  const two = draftsOf(storage, "two", ["one"]);
  one.keep("rules", "a.adirf", draft("of one"));
  expect(await two.takeOver("rules", "a.adirf")).toBeNull();
  expect(two.isElsewhere("rules", "a.adirf")).toBe(true);
  two.keep("rules", "a.adirf", draft("of two"));
  expect(await one.takeOver("rules", "a.adirf")).toEqual(draft("of one"));
});

test("of several drafts the newest stays", async () => {
  const storage = storageOf();
  draftsOf(storage, "one").keep("rules", "a.adirf", draft("new", 9));
  draftsOf(storage, "two").keep("rules", "a.adirf", draft("old", 3));
  expect(await draftsOf(storage, "three").takeOver("rules", "a.adirf")).toEqual(draft("new", 9));
  expect(storage.entries.size).toBe(1);
});

test("drafts are of one kind of file of one project", async () => {
  const storage = storageOf();
  const drafts = draftsOf(storage, "one");
  drafts.keep("rules", "a/b.adirf", draft("rules"));
  drafts.keep("profile", "b.toml", draft("table"));
  expect(drafts.names("rules")).toEqual(["a/b.adirf"]);
  expect(drafts.names("profile")).toEqual(["b.toml"]);
  expect(draftsOf(storage, "one", [], "other").names("rules")).toEqual([]);
  expect(await drafts.takeOver("profile", "a/b.adirf")).toBeNull();
});

test("a draft without room is said, and the one before it stays", async () => {
  const drafts = draftsOf(storageOf(80), "one");
  expect(drafts.keep("rules", "a.adirf", draft("short"))).toBe(true);
  expect(drafts.keep("rules", "a.adirf", draft("long".repeat(40)))).toBe(false);
  expect(drafts.hasRoom).toBe(false);
  expect(await drafts.takeOver("rules", "a.adirf")).toEqual(draft("short"));
});

test.each(["", "{", "null", '{"content": 3}'])("what is no draft, such as %j, is none", async (stored) => {
  const storage = storageOf();
  const drafts = draftsOf(storage, "one");
  drafts.keep("rules", "a.adirf", draft("typed"));
  for (const key of storage.entries.keys()) storage.entries.set(key, stored);
  storage.entries.set("profile of a.adirf", stored);
  expect(await drafts.takeOver("rules", "a.adirf")).toBeNull();
});
