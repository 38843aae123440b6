// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect } from "@preact/signals";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { openRules, refused } from "./served";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

/** Rules that are open, and the names of the topics that a robot has by now. */
async function beside(topics: string[]) {
  const robot = { topics, asked: 0, isThere: true };
  const editor = await openRules(
    { text: "begin\nend\n" },
    {
      "POST /api/vocabulary": () => {
        robot.asked++;
        return robot.isThere
          ? { topics: robot.topics.map((topic) => ({ topic })), every_topic: [], vitals: [] }
          : refused(504);
      },
    },
  );
  await editor.check();
  const offered: string[][] = [];
  const stop = effect(() => {
    offered.push(editor.words.offered()?.topics.map(({ topic }) => topic) ?? []);
  });
  return { robot, offered, stop };
}

test("who looks at what is offered sees topics that a robot has 5 s later at the latest", async () => {
  const { robot, offered } = await beside([]);
  robot.topics = ["/odom"];
  await vi.advanceTimersByTimeAsync(4900);
  expect(offered).toEqual([[]]);
  await vi.advanceTimersByTimeAsync(100);
  expect(offered).toEqual([[], ["/odom"]]);
});

test("the same topics are asked for once more, and not again until they are offered", async () => {
  const { robot, offered } = await beside(["/odom"]);
  await vi.advanceTimersByTimeAsync(60_000);
  expect([robot.asked, offered]).toEqual([2, [["/odom"]]]);
});

test("what is known stays where the server does not answer", async () => {
  const { robot, offered, stop } = await beside(["/odom"]);
  robot.isThere = false;
  await vi.advanceTimersByTimeAsync(60_000);
  stop();
  expect([robot.asked, offered]).toEqual([2, [["/odom"]]]);
});
