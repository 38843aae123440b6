// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { PlacedFinding } from "../../src/api/types";
import { layoutName, PLAIN_GRID } from "../../src/state/layout";
import { type Answers, type Disk, fileAnswers, openRules } from "./served";

afterEach(() => vi.unstubAllGlobals());

const WRONG = "SetFrequenzy";
const RIGHT = "SetFrequency";

/** Rules with a wrong word, on a server that finds it wherever it stands. */
async function misspelt() {
  const findings = (text: string) => {
    const offset = text.indexOf(WRONG);
    return offset < 0 ? [] : [{ code: "expected-statement", offset, fix: { title: RIGHT, edit: { offset } } }];
  };
  const editor = await openRules(
    { text: `begin ${WRONG} /odom 5 end` },
    {
      "POST /api/document": ({ text = "" }) => ({ collections: [], findings: findings(text), parses: true }),
      "POST /api/edit": ({ text = "" }) => {
        const edited = text.replace(WRONG, RIGHT);
        return { text: edited, document: { collections: [], findings: findings(edited), parses: true } };
      },
    },
  );
  return { editor, finding: editor.findings.peek()[0] as PlacedFinding };
}

test("a fix is done though the text was read again since the finding was shown", async () => {
  const { editor, finding } = await misspelt();
  editor.type(`${editor.text.value} // later`);
  await editor.fix(finding);
  expect(editor.text.value).toBe(`begin ${RIGHT} /odom 5 end // later`);
  expect(editor.findings.value).toEqual([]);
});

test("a fix of what is no longer there changes nothing, and that is said", async () => {
  const { editor, finding } = await misspelt();
  editor.type(`// first\n${editor.text.value}`);
  await editor.fix(finding);
  expect(editor.text.value).toBe(`// first\nbegin ${WRONG} /odom 5 end`);
  expect(editor.message.value).toContain("nothing was mended: try again");
});

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

const RULES = "begin\nend\n";
const FLOOR = { ...PLAIN_GRID, kind: "map" as const, name: "floor.yaml" };
beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

/** How a server answers that has these files. */
function filesAnswers(disks: Record<string, Disk>): Answers {
  const routes = ["GET /api/file/state", "GET /api/file", "PUT /api/file", "GET /api/draft", "PUT /api/draft"];
  const answer = (route: string) => (asked: Record<string, string>) => {
    const { name = "" } = asked;
    disks[name] = disks[name] ?? { text: null };
    return fileAnswers(name, disks[name])[route]?.(asked);
  };
  return Object.fromEntries(routes.map((route) => [route, answer(route)]));
}

/** Rules that are open, with what the side file of each name says of the map. */
async function opened(disks: Record<string, Disk> = { "a.adirf": { text: RULES } }) {
  const editor = await openRules({ text: null }, filesAnswers(disks));
  const mapOf = (name: string) => JSON.parse(disks[layoutName(name)]?.text ?? "null")?.map ?? null;
  return { editor, disks, mapOf };
}

test("a map that was chosen is saved beside its rules, each time that it is another", async () => {
  const { editor, mapOf } = await opened();
  await editor.save();
  expect(mapOf("a.adirf")).toBe(null);
  for (const map of [FLOOR, { ...FLOOR, bag: "walk" }]) {
    editor.map.value = map;
    expect(editor.isSaved.value).toBe(false);
    await editor.save();
    expect([mapOf("a.adirf"), editor.isSaved.value]).toEqual([map, true]);
  }
});

test("a map that was not saved comes back, and is dropped with the rest", async () => {
  const { editor, disks } = await opened();
  editor.map.value = FLOOR;
  editor.type("begin\n// mine\nend\n");
  await vi.runAllTimersAsync();
  const { editor: again } = await opened(disks);
  expect([again.map.value, again.text.value, again.isSaved.value]).toEqual([FLOOR, "begin\n// mine\nend\n", false]);
  await again.discard();
  expect([again.map.value, again.text.value, again.isSaved.value]).toEqual([PLAIN_GRID, RULES, true]);
});
