// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { layoutName, PLAIN_GRID } from "../../src/state/layout";
import { type Answers, type Disk, draftsIn, fileAnswers, openRules, storage } from "./served";

const RULES = "begin\nend\n";
const FLOOR = { ...PLAIN_GRID, kind: "map" as const, name: "floor.yaml" };
beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

/** How a server answers that has these files. */
function filesAnswers(disks: Record<string, Disk>): Answers {
  const routes = ["GET /api/file/state", "GET /api/file", "PUT /api/file"];
  const answer = (route: string) => (asked: Record<string, string>) => {
    const { name = "" } = asked;
    disks[name] = disks[name] ?? { text: null };
    return fileAnswers(name, disks[name])[route]?.(asked);
  };
  return Object.fromEntries(routes.map((route) => [route, answer(route)]));
}

/** Rules that are open, with what the side file of each name says of the map. */
async function opened(kept = storage(), disks: Record<string, Disk> = { "a.adirf": { text: RULES } }) {
  const editor = await openRules({ text: null }, filesAnswers(disks), draftsIn(kept));
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

test("rules that are saved as other ones take their map along, and none where none was chosen", async () => {
  const { editor, disks, mapOf } = await opened();
  await editor.saveAs("b.adirf");
  editor.map.value = FLOOR;
  await editor.saveAs("c.adirf");
  expect(["b.adirf", "c.adirf"].map((name) => [disks[name]?.text, mapOf(name)])).toEqual([
    [RULES, null],
    [RULES, FLOOR],
  ]);
  expect([mapOf("a.adirf"), editor.isSaved.value]).toEqual([null, true]);
});

test("a map that was not saved comes back, and is dropped with the rest", async () => {
  const kept = storage();
  const { editor, disks } = await opened(kept);
  editor.map.value = FLOOR;
  editor.type("begin\n// mine\nend\n");
  await vi.runAllTimersAsync();
  const { editor: again } = await opened(kept, disks);
  expect([again.map.value, again.text.value, again.isSaved.value]).toEqual([FLOOR, "begin\n// mine\nend\n", false]);
  await again.dropRestored();
  expect([again.map.value, again.text.value, again.isSaved.value]).toEqual([PLAIN_GRID, RULES, true]);
});
