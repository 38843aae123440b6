// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ReadonlySignal } from "@preact/signals";
import type { Vocabulary } from "../api/types";
import type { Suggestions } from "./fields";

/** What is said beside a topic that a running robot publishes. */
export const ON_ROBOT = "on the robot now";

/** What the vocabulary of the moment suggests; words for a field are read so that an effect follows them. */
export function suggestionsOf(vocabulary: ReadonlySignal<Vocabulary | null>): Suggestions {
  const known = (words: Vocabulary | null, topic: string) => words?.topics.find((each) => each.topic === topic);
  const properties = (words: Vocabulary | null, topic: string) => [
    ...(known(words, topic)?.properties ?? []),
    ...(words?.every_topic ?? []),
  ];
  const bounds = (words: Vocabulary | null, topic: string) => [
    ...(known(words, topic)?.bounds ?? []),
    ...(known(words, topic)?.properties ?? []),
  ];
  return {
    topics: () => vocabulary.peek()?.topics.map(({ topic }) => topic) ?? [],
    markedTopics: () =>
      vocabulary.value?.topics.map(({ topic, source }) =>
        source === "robot" ? { word: topic, note: ON_ROBOT } : topic,
      ) ?? [],
    properties: (topic) => properties(vocabulary.value, topic).map(({ name }) => name),
    bounds: (topic) => bounds(vocabulary.value, topic).map(({ name }) => name),
    unit: (topic, property) => {
      const all = [...properties(vocabulary.peek(), topic), ...bounds(vocabulary.peek(), topic)];
      return all.find(({ name }) => name === property)?.unit ?? "";
    },
  };
}
