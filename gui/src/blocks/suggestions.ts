// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Vocabulary } from "../api/types";
import type { Suggestions } from "./block_types";

/** What is said beside a topic that a running robot publishes. */
export const ON_ROBOT = "on the robot now";

/** What the vocabulary of the moment suggests. */
export function suggestionsOf(vocabulary: () => Vocabulary | null): Suggestions {
  const properties = (topic: string) => {
    const words = vocabulary();
    const own = words?.topics.find((each) => each.topic === topic)?.properties ?? [];
    return [...own, ...(words?.every_topic ?? [])];
  };
  return {
    topics: () => vocabulary()?.topics.map(({ topic }) => topic) ?? [],
    markedTopics: () =>
      vocabulary()?.topics.map(({ topic, source }) => (source === "robot" ? { word: topic, note: ON_ROBOT } : topic)) ??
      [],
    properties: (topic) => properties(topic).map(({ name }) => name),
    unit: (topic, property) => properties(topic).find(({ name }) => name === property)?.unit ?? "",
  };
}
