// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect, signal } from "@preact/signals";
import { expect, test } from "vitest";
import type { Vocabulary } from "../../src/api/types";
import { ON_ROBOT, suggestionsOf } from "../../src/blocks/suggestions";

test("what is suggested grows when a robot's topics come later", () => {
  const vocabulary = signal<Vocabulary | null>(null);
  const suggestions = suggestionsOf(vocabulary);
  const shown: unknown[] = [];
  const stop = effect(() => {
    shown.push([suggestions.markedTopics(), suggestions.properties("/odom"), suggestions.bounds("/odom")]);
  });
  const speed = { name: "speed", unit: "m/s", meaning: "of the robot" };
  const position = { name: "position", unit: "m", meaning: "of the robot" };
  const age = { name: "age", unit: "s", meaning: "since the last message" };
  vocabulary.value = {
    topics: [
      { topic: "/odom", type: "nav_msgs/msg/Odometry", source: "robot", properties: [speed], bounds: [position] },
    ],
    every_topic: [age],
  };
  stop();
  expect(shown).toEqual([
    [[], [], []],
    [[{ word: "/odom", note: ON_ROBOT }], ["speed", "age"], ["position", "speed"]],
  ]);
  expect(suggestions.unit("/odom", "position")).toBe("m");
});
