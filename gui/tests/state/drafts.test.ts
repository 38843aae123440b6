// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { type DraftStorage, LocalDrafts } from "../../src/state/drafts";

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

const draftsOf = (storage: DraftStorage, page: string, project = "shelf") => new LocalDrafts(storage, project, page);
const draft = (content: string, changedMs = 1) => ({
  content,
  beside: "",
  base_hash: "a",
  knownIds: ["one 0"],
  changedMs,
});

test("the next page goes on with the draft of one that is gone", () => {
  const storage = storageOf();
  draftsOf(storage, "one").keep("a.adirf", draft("typed"));
  const two = draftsOf(storage, "two");
  expect(two.takeOver("a.adirf")).toEqual(draft("typed"));
  two.drop("a.adirf");
  expect(storage.entries.size).toBe(0);
});

test("two pages write beside each other, the newest is taken first, and the other one next", () => {
  const storage = storageOf();
  draftsOf(storage, "one").keep("a.adirf", draft("new", 9));
  draftsOf(storage, "two").keep("a.adirf", draft("old", 3));
  expect(storage.entries.size).toBe(2);
  const three = draftsOf(storage, "three");
  expect(three.takeOver("a.adirf")).toEqual(draft("new", 9));
  three.drop("a.adirf");
  expect(draftsOf(storage, "four").takeOver("a.adirf")).toEqual(draft("old", 3));
});

test("drafts are of one file of one project", () => {
  const storage = storageOf();
  const drafts = draftsOf(storage, "one");
  drafts.keep("a/b.adirf", draft("rules"));
  drafts.keep("b.toml", draft("table"));
  expect(drafts.names()).toEqual(["a/b.adirf", "b.toml"]);
  expect(draftsOf(storage, "one", "other").names()).toEqual([]);
  expect(drafts.takeOver("c.adirf")).toBeNull();
});

test("a draft without room is said, and the one before it stays", () => {
  const drafts = draftsOf(storageOf(120), "one");
  drafts.keep("a.adirf", draft("short"));
  expect(drafts.hasRoom).toBe(true);
  drafts.keep("a.adirf", draft("long".repeat(40)));
  expect(drafts.hasRoom).toBe(false);
  expect(drafts.takeOver("a.adirf")).toEqual(draft("short"));
});

test("no two drafts have one name", () => {
  const storage = storageOf();
  const [one, two] = [draftsOf(storage, "one"), draftsOf(storage, "two")];
  expect(new Set([one.newId(), one.newId(), two.newId()]).size).toBe(3);
});

test.each(["", "{", "null", '{"content": 3}'])("what is no draft, such as %j, is none", (stored) => {
  const storage = storageOf();
  const drafts = draftsOf(storage, "one");
  drafts.keep("a.adirf", draft("typed"));
  for (const key of storage.entries.keys()) storage.entries.set(key, stored);
  for (const key of ["profile of a.adirf", "5", "null"]) storage.entries.set(key, stored);
  expect(drafts.takeOver("a.adirf")).toBeNull();
});
