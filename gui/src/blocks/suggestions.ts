// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ReadonlySignal } from "@preact/signals";
import { type KnownTopic, type Live, type Property, TIERS, type Vocabulary } from "../api/types";
import type { VocabularyCache } from "../state/statements";
import type { Trial } from "../state/trial";
import { hz, readable } from "../ui/numbers";
import type { PickerChoice } from "../ui/picker";
import type { Suggestions } from "./fields";
import { readChecks } from "./live_states";

/** What is said beside a topic that a running robot publishes. */
export const ON_ROBOT = "on the robot now";

/** Everything that is known of topics now; what a field offers follows each of them. */
interface KnownNow {
  /** The topic parameters of the rules. */
  profile: ReadonlySignal<{ name: string } | null>;
  words: Pick<VocabularyCache, "vocabulary" | "offered">;
  live: ReadonlySignal<Live | null>;
  /** The last try of the rules on a recording. */
  tried: ReadonlySignal<Trial | null>;
}

/** What is suggested of what is known at the moment; words for a field are read so that an effect follows them. */
export function suggestionsOf(now: KnownNow): Omit<Suggestions, "drawValues"> {
  const { vocabulary } = now.words;
  const known = (words: Vocabulary | null, topic: string) => words?.topics.find((each) => each.topic === topic);
  const properties = (words: Vocabulary | null, topic: string) =>
    words?.vitals.find(({ name }) => name === topic)?.properties ?? [
      ...(known(words, topic)?.properties ?? []),
      ...(words?.every_topic ?? []),
    ];
  const bounds = (words: Vocabulary | null, topic: string) => [
    ...(known(words, topic)?.bounds ?? []),
    ...(known(words, topic)?.properties ?? []),
  ];
  const choice = (topic: string) => (property: Property) => propertyChoice(now, topic, property);
  return {
    topics: () => vocabulary.peek()?.topics.map(({ topic }) => topic) ?? [],
    topicChoices: () => now.words.offered()?.topics.map((topic) => topicChoice(now, topic)) ?? [],
    vitalsChoices: () => vocabulary.peek()?.vitals.map(({ name, meaning }) => ({ word: name, note: meaning })) ?? [],
    properties: (topic) => properties(vocabulary.value, topic).map(choice(topic)),
    bounds: (topic) => bounds(vocabulary.value, topic).map(choice(topic)),
    rates: (topic) => [
      { word: "Full", aside: "every message" },
      { word: "Off", aside: "no message" },
      ...TIERS.map((word, at) => ({ word, aside: rateWords(known(vocabulary.value, topic)?.levels_hz?.[at]) })),
    ],
    boundLevels: (topic, name) => {
      const property = bounds(vocabulary.value, topic).find((each) => each.name === name);
      return TIERS.map((word, at) => ({ word, aside: boundWords(property?.levels?.[at], property?.unit ?? "") }));
    },
    unit: (topic, property) => {
      const all = [...properties(vocabulary.peek(), topic), ...bounds(vocabulary.peek(), topic)];
      return all.find(({ name }) => name === property)?.unit ?? "";
    },
  };
}

function topicChoice(now: KnownNow, known: KnownTopic): PickerChoice {
  const users = known.used_by.map((user) => (user === "default" ? "a default" : user));
  const use = users.length > 0 ? `used by ${users.join(", ")}` : "";
  return { word: known.topic, aside: sourceWords(now, known), note: [known.type, use].filter(Boolean).join(" · ") };
}

/** How often a topic comes: on the robot, else in a recording, else by the topic parameters. */
function sourceWords({ profile, live, tried }: KnownNow, { topic, is_published, source_hz }: KnownTopic): string {
  const relayed = live.value?.status.topics[topic];
  if (relayed?.source_hz != null) return `${hz(relayed.source_hz)} on the robot`;
  if (relayed?.silent) return "silent on the robot";
  if (is_published || relayed) return ON_ROBOT;
  if (live.value !== null) return "the robot has none";
  const seen = tried.value;
  const rate_hz = seen?.sourceHz(topic) ?? null;
  if (seen && rate_hz !== null) return `${hz(rate_hz)} in ${seen.bag}`;
  return source_hz === null ? "" : `${hz(source_hz)} in ${profile.value?.name ?? "the topic parameters"}`;
}

function propertyChoice({ live, tried }: KnownNow, topic: string, { name, unit, meaning }: Property): PickerChoice {
  const check = live.value && readChecks(live.value).find((each) => each.topic === topic && each.property === name);
  const seen = tried.value;
  const range = seen?.rangeOf(topic, name);
  const now = check?.value != null ? `now ${readable(check.value)}` : "";
  const then = seen && range ? `${readable(range[0])} … ${readable(range[1])}` : "";
  const value = now || then;
  const aside = [value, unit].filter(Boolean).join(" ");
  return { word: name, aside: !now && seen && then ? `${aside} in ${seen.bag}` : aside, note: meaning };
}

const NO_LEVELS = "no levels in the topic parameters";

function rateWords(range: readonly [number, number] | undefined): string {
  if (!range) return NO_LEVELS;
  const [least, most] = range;
  return least === 0 ? `up to ${hz(most)}` : `${readable(least)} – ${hz(most)}`;
}

function boundWords(range: readonly [number, number] | undefined, unit: string): string {
  if (!range) return NO_LEVELS;
  const [loosest, tightest] = range;
  return loosest === tightest
    ? `${readable(tightest)} ${unit}`
    : `${readable(loosest)} – ${readable(tightest)} ${unit}`;
}
