// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect, type Signal, signal } from "@preact/signals";
import { expect, test } from "vitest";
import type { KnownTopic, Live, RecordedField, RobotCheck, TopicStatus, Vocabulary } from "../../src/api/types";
import { ON_ROBOT, patternsOf, suggestionsOf } from "../../src/blocks/suggestions";
import type { Trial } from "../../src/state/trial";

const NUMBER = { kind: "number" as const, words: [], levels: null };
const SPEED = { name: "speed", unit: "m/s", meaning: "of the robot", ...NUMBER };
const POSITION = { name: "position", unit: "m", meaning: "where it is", ...NUMBER };
const AGE = { name: "age", unit: "s", meaning: "since the last message", ...NUMBER };
const USED = { name: "used", unit: "%", meaning: "share of the capacity in use", ...NUMBER };
const LINK = { name: "@link", meaning: "the link to the operators", properties: [USED] };
const ALLOWED = { parameters: { "/controller": ["max_speed"] }, calls: ["/light"] };
const ODOM: KnownTopic = {
  topic: "/odom",
  type: "nav_msgs/msg/Odometry",
  source: "profile",
  properties: [SPEED],
  bounds: [POSITION],
  source_hz: 20,
  levels_hz: null,
  used_by: ["default", "Corridor"],
  is_published: false,
};

function wordsOf(vocabulary: Signal<Vocabulary | null>) {
  return { vocabulary, offered: () => vocabulary.value };
}

function known(topic: Partial<KnownTopic> = {}, profile = signal<{ name: string } | null>({ name: "radio.toml" })) {
  const vocabulary = signal<Vocabulary | null>({
    topics: [{ ...ODOM, ...topic }],
    every_topic: [AGE],
    vitals: [LINK],
    allowed: ALLOWED,
  });
  const live = signal<Live | null>(null);
  const tried = signal<Trial | null>(null);
  const fields = signal<RecordedField[]>([]);
  const topics = signal<string[]>([]);
  return {
    vocabulary,
    live,
    tried,
    fields,
    topics,
    suggestions: suggestionsOf({
      words: wordsOf(vocabulary),
      profile,
      live,
      tried,
      recorded: { of: () => fields.value, topics: () => topics.value },
    }),
  };
}

function robot(
  topics: Record<string, Partial<TopicStatus>>,
  checks: Partial<RobotCheck>[] = [],
  value: number | string = 0,
): Live {
  const blocks = [{ checks: checks.map(() => [4, 7, "true", value]) }];
  return { status: { topics, blocks }, checks } as unknown as Live;
}

test("what is suggested grows when a robot's topics come later", () => {
  const vocabulary = signal<Vocabulary | null>(null);
  const recorded = { of: () => [], topics: () => [] };
  const nothing = { profile: signal(null), live: signal(null), tried: signal(null), recorded };
  const suggestions = suggestionsOf({ words: wordsOf(vocabulary), ...nothing });
  const shown: unknown[] = [];
  const words = (choices: readonly { word: string }[]) => choices.map(({ word }) => word);
  const stop = effect(() => {
    shown.push([
      suggestions.topicChoices().map(({ word, aside }) => [word, aside]),
      words(suggestions.properties("/odom")),
      words(suggestions.bounds("/odom")),
    ]);
  });
  vocabulary.value = {
    topics: [{ ...ODOM, is_published: true }],
    every_topic: [AGE],
    vitals: [LINK],
    allowed: ALLOWED,
  };
  stop();
  expect(shown).toEqual([
    [[], [], []],
    [[["/odom", ON_ROBOT]], ["speed", "age"], ["position", "speed"]],
  ]);
  expect(suggestions.unit("/odom", "position")).toBe("m");
});

test("a topic says its type, who uses it, and how often it comes by who knows best", () => {
  const { live, tried, suggestions } = known();
  const aside = () => suggestions.topicChoices()[0]?.aside;
  expect(suggestions.topicChoices()[0]?.note).toBe("nav_msgs/msg/Odometry · used by a default, Corridor");
  expect(aside()).toBe("20 Hz in radio.toml");
  tried.value = { bag: "monday", sourceHz: () => 19.96 } as unknown as Trial;
  expect(aside()).toBe("20 Hz in monday");
  live.value = robot({});
  expect(aside()).toBe("the robot has none");
  live.value = robot({ "/odom": { source_hz: 9.87 } });
  expect(aside()).toBe("9.87 Hz on the robot");
});

test("a topic that neither robot nor recording nor profile has is marked, and those of the recording are offered", () => {
  const nowhere = "not on the robot, in the recording or the profile";
  const { live, topics, suggestions } = known({ topic: "/sacn", source: "rules", source_hz: null });
  const choices = () => suggestions.topicChoices().map(({ word, aside }) => [word, aside]);
  expect([choices(), suggestions.unknown()]).toEqual([[["/sacn", nowhere]], nowhere]);
  live.value = robot({ "/sacn": { source_hz: 5 } });
  expect(choices()).toEqual([["/sacn", "5 Hz on the robot"]]);
  live.value = null;
  topics.value = ["/sacn", "/scan"];
  expect(choices()).toEqual([
    ["/sacn", "in the recording"],
    ["/scan", "in the recording"],
  ]);
});

test("where there is nothing that could know a topic, none is marked", () => {
  const profile = signal<{ name: string } | null>(null);
  const { suggestions } = known({ source: "example", source_hz: null }, profile);
  expect([suggestions.topicChoices()[0]?.aside, suggestions.unknown()]).toEqual(["", ""]);
});

test("the link stands beside the topics of a check, with properties of its own only", () => {
  const { suggestions } = known();
  expect(suggestions.vitalsChoices()).toEqual([{ word: "@link", note: "the link to the operators" }]);
  expect(suggestions.topics()).toEqual(["/odom"]);
  expect(suggestions.properties("@link").map(({ word }) => word)).toEqual(["used"]);
  expect(suggestions.unit("@link", "used")).toBe("%");
});

test("a property says its value on the robot, else what it was in the recording, in its unit", () => {
  const { live, tried, suggestions } = known();
  const aside = () => suggestions.properties("/odom")[0]?.aside;
  expect(aside()).toBe("m/s");
  tried.value = { bag: "monday", rangeOf: () => [-0.1, 1.2345] } as unknown as Trial;
  expect(aside()).toBe("-0.1 … 1.23 m/s in monday");
  live.value = robot({}, [{ topic: "/odom", property: "speed" }], 0.5);
  expect(aside()).toBe("now 0.5 m/s");
});

test("a level says the rates that it means for the topic, or that nobody has said them", () => {
  const levels_hz = [
    [0, 1],
    [1, 2],
    [2, 5],
    [5, 10],
    [10, 15],
    [20, 30],
  ] as [number, number][];
  const asides = (topic: Partial<KnownTopic>) =>
    known(topic)
      .suggestions.rates("/odom")
      .map(({ word, aside }) => `${word}: ${aside}`);
  expect(asides({ levels_hz }).slice(0, 4)).toEqual([
    "Full: every message",
    "Off: no message",
    "Unacceptable: up to 1 Hz",
    "Marginal: 1 – 2 Hz",
  ]);
  expect(asides({})[2]).toBe("Unacceptable: no levels in the topic parameters");
});

const words = (choices: readonly { word: string }[] | null) => choices?.map(({ word }) => word);

test("a number with a name is a number for sure; of a field that nobody knows anything can be", () => {
  const { suggestions } = known();
  expect(suggestions.words("/odom", "speed")).toBeNull();
  expect(suggestions.words("/mode", "data")).toEqual([]);
});

test("constants come first, then the text on the robot, then those of the recording", () => {
  const mode = { name: "data", unit: "", meaning: "", kind: "text" as const, words: ["IDLE"], levels: null };
  const { fields, live, suggestions } = known({ properties: [mode] });
  expect(words(suggestions.words("/odom", "data"))).toEqual(["IDLE"]);
  fields.value = [{ path: "data", kind: "text", texts: ['a "b"', "docking"] }];
  live.value = robot({}, [{ topic: "/odom", property: "data" }], "docking");
  expect(words(suggestions.words("/odom", "data"))).toEqual(["IDLE", '"docking"', '"a \\"b\\""']);
  expect(suggestions.properties("/odom")[0]?.aside).toBe("now “docking”");
});

test("named elements and texts of a recording are properties, each of its numbers is none", () => {
  const { fields, suggestions } = known();
  const field = (path: string, kind: RecordedField["kind"], texts: string[] = []) => ({ path, kind, texts });
  fields.value = [
    field("twist.twist.linear.x", "number"),
    field("child_frame_id", "text", ["base", "odom", "x"]),
    field('status["lidar front"].level', "number"),
    field("is_on", "truth"),
  ];
  const named = ['status["lidar front"].level', "is_on"];
  expect(words(suggestions.properties("/odom"))).toEqual(["speed", "age", "child_frame_id", ...named]);
  expect(words(suggestions.words("/odom", "is_on"))).toEqual(["true", "false"]);
  expect(suggestions.properties("/odom")[2]?.aside).toBe('"base", "odom", …');
});

test("topics of a kind are those below a name and those that end alike", () => {
  const topics = ["/camera/left/image", "/camera/right/image", "/scan", "/_hidden/image", "/arm/image"];
  const all = patternsOf(topics).map(({ word, aside }) => [word, aside]);
  expect(all).toEqual([
    ["/**/image", "3 topics now"],
    ["/camera/**", "2 topics now"],
  ]);
});

test("an action names what the topic parameters allow", () => {
  const { suggestions } = known();
  expect(words(suggestions.allowed({ kind: "node" }))).toEqual(["/controller"]);
  expect(words(suggestions.allowed({ kind: "parameter", node: "/controller" }))).toEqual(["max_speed"]);
  expect(words(suggestions.allowed({ kind: "parameter", node: "/other" }))).toEqual([]);
  expect(words(suggestions.allowed({ kind: "service" }))).toEqual(["/light"]);
});
