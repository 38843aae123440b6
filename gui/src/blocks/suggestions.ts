// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ReadonlySignal } from "@preact/signals";
import { type KnownTopic, type Live, type Property, type RecordedField, TIERS, type Vocabulary } from "../api/types";
import type { RecordingWords } from "../state/recording_words";
import type { VocabularyCache } from "../state/statements";
import type { Trial } from "../state/trial";
import { hz, readable, valueText } from "../ui/numbers";
import type { PickerChoice } from "../ui/picker";
import { quoted } from "./compared";
import type { Allowed, Suggestions } from "./fields";
import { readChecks } from "./live_states";

const IN_RECORDING = "in the recording";
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
  /** The topics of the recording of the rules and the fields of one, as far as they were read by now. */
  recorded: Pick<RecordingWords, "of" | "topics">;
}

/** What is suggested of what is known at the moment; words for a field are read so that an effect follows them. */
export function suggestionsOf(now: KnownNow): Omit<Suggestions, "drawValues" | "zones"> {
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
    topicChoices: () => topicChoices(now),
    unknown: () => unknownWords(now),
    patternChoices: () => patternsOf(vocabulary.peek()?.topics.map(({ topic }) => topic) ?? []),
    vitalsChoices: () => vocabulary.peek()?.vitals.map(({ name, meaning }) => ({ word: name, note: meaning })) ?? [],
    properties: (topic) => {
      const known = properties(vocabulary.value, topic);
      const names = new Set(known.map(({ name }) => name));
      const more = now.recorded.of(topic).filter((field) => !names.has(field.path) && isWorthNaming(field, known));
      return [...known.map(choice(topic)), ...more.map(recordedChoice)];
    },
    words: (topic, name) => {
      const all = properties(vocabulary.value, topic);
      const found = all.find((each) => each.name === name) ?? all.find((each) => each.name === anyElement(name));
      return wordChoices(now, topic, name, found);
    },
    allowed: (what) =>
      allowedWords(vocabulary.value?.allowed, what).map((word) => ({ word, note: "allowed to rules" })),
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

const NOWHERE = "not on the robot, in the recording or the profile";

/** What is said of a topic that nobody knows; nothing where there is neither robot, recording nor profile to know it. */
function unknownWords({ profile, live, recorded }: KnownNow): string {
  const isAnything = profile.value !== null || live.value !== null || recorded.topics().length > 0;
  return isAnything ? NOWHERE : "";
}

function topicChoices(now: KnownNow): PickerChoice[] {
  const topics = now.words.offered()?.topics ?? [];
  const known = new Set(topics.map(({ topic }) => topic));
  const more = now.recorded.topics().filter((topic) => !known.has(topic));
  return [...topics.map((topic) => topicChoice(now, topic)), ...more.map((word) => ({ word, aside: IN_RECORDING }))];
}

function topicChoice(now: KnownNow, known: KnownTopic): PickerChoice {
  const users = known.used_by.map((user) => (user === "default" ? "a default" : user));
  const use = users.length > 0 ? `used by ${users.join(", ")}` : "";
  return { word: known.topic, aside: sourceWords(now, known), note: [known.type, use].filter(Boolean).join(" · ") };
}

const MOST_PATTERNS = 12;

/** Patterns that stand for at least two topics each: all below a name, and all that end alike. */
export function patternsOf(topics: readonly string[]): PickerChoice[] {
  const counts = new Map<string, number>();
  for (const topic of topics) {
    const parts = topic.split("/").slice(1);
    if (parts.length < 2 || parts.some((part) => part.startsWith("_") || part.includes("*"))) continue;
    for (const pattern of [`/${parts[0]}/**`, `/**/${parts.at(-1)}`]) {
      counts.set(pattern, (counts.get(pattern) ?? 0) + 1);
    }
  }
  return [...counts]
    .filter(([, count]) => count > 1)
    .sort(([, a], [, b]) => b - a)
    .slice(0, MOST_PATTERNS)
    .map(([word, count]) => ({ word, aside: `${count} topics now`, note: "all topics of a kind, later ones too" }));
}

/** What a property can be equal to: its own words, then what it is on the robot and was in a recording. */
function wordChoices(now: KnownNow, topic: string, name: string, property?: Property): PickerChoice[] | null {
  const field = now.recorded.of(topic).find(({ path }) => path === name);
  const kind = property?.kind ?? field?.kind;
  const words = property?.words ?? (kind === "truth" ? ["true", "false"] : []);
  if (kind === "number" && words.length === 0) return null;
  const check = now.live.value && readChecks(now.live.value).find((each) => isOf(each, topic, name));
  const value = typeof check?.value === "string" ? [check.value] : [];
  const texts = (field?.texts ?? []).filter((text) => text !== check?.value);
  return [
    ...words.map((word) => ({ word })),
    ...value.map((text) => ({ word: quoted(text), aside: ON_ROBOT })),
    ...texts.map((text) => ({ word: quoted(text), aside: IN_RECORDING })),
  ];
}

/** The path of a field of any element, where a path says of which. */
function anyElement(path: string): string {
  return path.replace(/\[(?:"(?:[^"\\]|\\.)*"|-?\d+)\]/g, "[*]");
}

function allowedWords(allowed: Vocabulary["allowed"] | undefined, what: Allowed): readonly string[] {
  switch (what.kind) {
    case "node":
      return Object.keys(allowed?.parameters ?? {});
    case "parameter":
      return allowed?.parameters[what.node] ?? [];
    case "service":
      return allowed?.calls ?? [];
  }
}

function isOf(check: { topic: string; property: string }, topic: string, property: string): boolean {
  return check.topic === topic && check.property === property;
}

/** Whether a field of a recording is worth a line beside the properties that have names: not each number of a message. */
function isWorthNaming({ path, kind }: RecordedField, known: readonly Property[]): boolean {
  return kind !== "number" || path.includes("[") || known.every(({ meaning }) => meaning === "");
}

function recordedChoice({ path, texts }: RecordedField): PickerChoice {
  const some = texts.slice(0, 2).map(quoted).join(", ");
  return { word: path, aside: texts.length > 2 ? `${some}, …` : some, note: IN_RECORDING };
}

/** How often a topic comes: on the robot, else in a recording, else by the topic parameters. */
function sourceWords(now: KnownNow, { topic, is_published, source, source_hz }: KnownTopic): string {
  const { profile, live, tried, recorded } = now;
  const relayed = live.value?.status.topics[topic];
  if (relayed?.source_hz != null) return `${hz(relayed.source_hz)} on the robot`;
  if (relayed?.silent) return "silent on the robot";
  if (is_published || relayed) return ON_ROBOT;
  const seen = tried.value;
  const rate_hz = seen?.sourceHz(topic) ?? null;
  const isRecorded = rate_hz !== null || recorded.topics().includes(topic);
  if (source !== "profile" && !isRecorded) return unknownWords(now);
  if (live.value !== null) return "the robot has none";
  if (seen && rate_hz !== null) return `${hz(rate_hz)} in ${seen.bag}`;
  if (source_hz !== null) return `${hz(source_hz)} in ${profile.value?.name ?? "the topic parameters"}`;
  return isRecorded ? IN_RECORDING : "";
}

function propertyChoice({ live, tried }: KnownNow, topic: string, { name, unit, meaning }: Property): PickerChoice {
  const check = live.value && readChecks(live.value).find((each) => isOf(each, topic, name));
  const seen = tried.value;
  const range = seen?.rangeOf(topic, name);
  const now = check?.value != null ? `now ${valueText(check.value)}` : "";
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
