// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from "vitest";
import { Api } from "../../src/api/client";
import type { FoundFile, TriedRecording, TryHeadline, WorstTopic } from "../../src/api/types";
import { COLUMNS, type Column, FolderTrial, MAX_ROWS, totalOf, WORST_FIRST } from "../../src/state/trial";

const RULES = { text: "begin end", name: "far.adirf", profile_text: null };
const LOST: WorstTopic = { topic: "/odom", sent: 9, received: 3, longest_s: 2, more_s: 1, is_image: false };
const HEADLINE: TryHeadline = {
  ...{ duration_s: 10, before_kb: 100, after_kb: 20, percent: 80, notices: [] },
  ...{ worst_topic: LOST, worst_field: null, crossings: 0, missed_crossings: 0 },
};
const found = (name: string): FoundFile => ({ name, kind: "bag", size_bytes: 1, changed_at_s: 1 });
const lost = (more_s: number | null) => ({ worst_topic: { ...LOST, more_s } });
const field = (share: number) => ({ topic: "/odom", field: "x", unit: "m", rmse: 1, share });

function folder(headlines: Record<string, Partial<TryHeadline>>): FolderTrial {
  const trial = new FolderTrial("runs/", RULES, Object.keys(headlines).map(found));
  trial.rows.value = Object.entries(headlines).map(([bag, some]) => ({ bag, headline: { ...HEADLINE, ...some } }));
  return trial;
}

const names = (trial: FolderTrial) => trial.shown.value.map(({ bag }) => bag);

/** Answers requests one by one: with a body, a refusal, or never. */
function server(answers: (TriedRecording | number | "never")[]): unknown[] {
  const asked: unknown[] = [];
  vi.stubGlobal("fetch", (_: string, { body, signal }: { body: string; signal: AbortSignal }) => {
    asked.push(JSON.parse(body));
    const answer = answers.shift() ?? 500;
    if (answer !== "never") {
      const isRefused = typeof answer === "number";
      return Promise.resolve(
        new Response(JSON.stringify(isRefused ? {} : answer), { status: isRefused ? answer : 200 }),
      );
    }
    return new Promise((_resolve, reject) => signal.addEventListener("abort", () => reject(signal.reason)));
  });
  return asked;
}
const done = (some: Partial<TryHeadline> = {}): TriedRecording => ({
  headline: { ...HEADLINE, ...some },
  problem: "",
  remedy: "",
});
afterEach(() => vi.unstubAllGlobals());

test("recordings are tried one by one with the rules that the run began with, and one that is broken costs no other", async () => {
  const asked = server([done(), { headline: null, problem: "it is empty", remedy: "record it again" }, done()]);
  const trial = new FolderTrial("runs/", RULES, ["runs/a", "runs/b", "runs/c"].map(found));
  const told: number[] = [];
  await trial.run(new Api(), "7", new AbortController().signal, (share) => told.push(share));
  expect(asked).toEqual(["runs/a", "runs/b", "runs/c"].map((bag, at) => ({ ...RULES, bag, run: `7 part ${at}` })));
  expect(told).toEqual([1 / 3, 2 / 3, 1]);
  expect(trial.rows.value.map(({ bag }) => trial.nameOf(bag))).toEqual(["a", "c"]);
  expect(trial.problems.value).toEqual([{ bag: "runs/b", why: "It is empty. Record it again" }]);
  expect(trial.done).toBe(3);
});

test("what was tried stays where the run is cancelled, or the server refuses to go on", async () => {
  const [cancelled, refused] = [1, 2].map(() => new FolderTrial("/", RULES, ["a", "b", "c"].map(found)));
  server([done(), "never"]);
  const control = new AbortController();
  const run = cancelled?.run(new Api(), "7", control.signal, () => undefined);
  await vi.waitUntil(() => cancelled?.done === 1);
  expect(cancelled?.share(0.5, 1)).toBe(0.5);
  // What is told late of a recording counts for no other.
  expect(cancelled?.share(1, 0)).toBe(1 / 3);
  control.abort();
  await expect(run).rejects.toThrow();
  server([done(), 409]);
  await expect(refused?.run(new Api(), "7", new AbortController().signal, () => undefined)).rejects.toThrow();
  expect([cancelled, refused].map((trial) => trial?.rows.value.length)).toEqual([1, 1]);
});

test("the worst stands first: what never arrived, then the oldest, then thresholds, errors and names", () => {
  const trial = folder({
    nothing_lost: { worst_topic: null },
    z: {},
    a: {},
    off_errs: { ...lost(null), worst_field: field(0.5) },
    off: lost(null),
    off_missed: { ...lost(null), missed_crossings: 1, crossings: 1 },
    older: lost(30),
    younger_than_sent: lost(-1),
  });
  const worst = ["off_missed", "off_errs", "off", "older", "a", "z", "younger_than_sent", "nothing_lost"];
  expect(names(trial)).toEqual(worst);
});

test.each([
  ["recording", ["a", "b", "c"]],
  ["sent", ["c", "a", "b"]],
  ["less", ["b", "a", "c"]],
  ["loss", ["a", "b", "c"]],
  ["error", ["b", "a", "c"]],
  ["missed", ["c", "a", "b"]],
] as [Column, string[]][])("rows are sorted by %s", (column, expected) => {
  const trial = folder({
    a: { ...lost(9), percent: 50 },
    b: { ...lost(8), percent: 20, duration_s: 20, worst_field: field(0.1) },
    c: { ...lost(7), percent: 90, after_kb: 30, crossings: 3, missed_crossings: 2 },
  });
  trial.order.value = { column, isDown: COLUMNS[column].isDown };
  expect(names(trial)).toEqual(expected);
});

test("of thousands the worst hundred are shown, and the total is that of all", () => {
  const count = 2000;
  const trial = folder(Object.fromEntries(Array.from({ length: count }, (_, each) => [`r${each}`, lost(each)])));
  expect(trial.order.value).toEqual(WORST_FIRST);
  expect(names(trial)).toEqual(Array.from({ length: MAX_ROWS }, (_, each) => `r${count - 1 - each}`));
  expect(totalOf(trial.rows.value)).toEqual({
    ...{ duration_s: 10 * count, after_kb: 20 * count, percent: 80 },
    ...{ crossings: 0, missed_crossings: 0 },
  });
});
