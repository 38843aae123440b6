// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { CompletionContext } from "@codemirror/autocomplete";
import { EditorState } from "@codemirror/state";
import { expect, test } from "vitest";
import type { Vocabulary } from "../../src/api/types";
import { colouredIn, suggest } from "../../src/text/text_editor";

const NUMBER = { kind: "number" as const, words: [], levels: null };
const property = (name: string) => ({ name, unit: "m", meaning: "", ...NUMBER });
const VOCABULARY: Vocabulary = {
  topics: [
    {
      topic: "/odom",
      type: "nav_msgs/msg/Odometry",
      source: "example",
      properties: [property("pose_x"), { ...property("mode"), words: ["IDLE", "BUSY"] }],
      bounds: [property("position")],
      source_hz: null,
      levels_hz: null,
      used_by: [],
      is_published: false,
    },
  ],
  every_topic: [property("age")],
  vitals: [{ name: "@link", meaning: "the link to the operators", properties: [property("used"), property("age")] }],
  allowed: { parameters: {}, calls: [] },
};

test.each([
  ["CheckValue /odom ", ["pose_x", "mode", "age"]],
  ["CheckValue /odom mode != ", ["IDLE", "BUSY"]],
  ["KeepWithin /odom ", ["position", "pose_x", "mode"]],
  ["KeepWithin ", ["/odom"]],
  ["CheckValue ", ["/odom", "@link"]],
  ["CheckValue @", ["@link"]],
  ["CheckValue @link ", ["used", "age"]],
  ['Record "near miss" ', ["/odom"]],
])("behind %j is suggested %j", (text, labels) => {
  const state = EditorState.create({ doc: text });
  const found = suggest(new CompletionContext(state, text.length, true), VOCABULARY);
  expect(found?.options.map(({ label }) => label)).toEqual(labels);
});

test.each(["// SetF", "SetFrequency /odom 4 // Check", "//"])("in the comment %j nothing is suggested", (text) => {
  const state = EditorState.create({ doc: text });
  expect(suggest(new CompletionContext(state, text.length, true), VOCABULARY)).toBeNull();
});

test("a name with // in it begins no comment", () => {
  const text = 'Record "near // miss" ';
  const state = EditorState.create({ doc: text });
  expect(suggest(new CompletionContext(state, text.length, true), VOCABULARY)?.options).toHaveLength(1);
});

test("a number is not completed", () => {
  const state = EditorState.create({ doc: "SetFrequency /odom 4" });
  expect(suggest(new CompletionContext(state, state.doc.length, true), VOCABULARY)).toBeNull();
});

test.each([
  ['Rule "Not // here" Priority 2', ["keyword Rule", 'string "Not // here"', "keyword Priority", "rate 2"]],
  [
    "CheckValue @link used > 1 SetFrequency /a/*/b 2 .. 5 By",
    [
      "logic CheckValue",
      "topic @link",
      "rate 1",
      "keyword SetFrequency",
      "topic /a/*/b",
      "rate 2",
      "rate 5",
      "keyword By",
    ],
  ],
  [
    'CheckValue /d status["a \\"b\\" //c"].level = true Call /stop',
    ["logic CheckValue", "topic /d", "rate true", "keyword Call", "topic /stop"],
  ],
  ["SetFrequency/odom Off // slow", ["keyword SetFrequency", "topic /odom", "rate Off", "comment // slow"]],
  [
    "CheckValue /odom\n// of it\nPriority > -1.5e3",
    ["logic CheckValue", "topic /odom", "comment // of it", "rate -1.5e3"],
  ],
  ["CheckValue /odom Full < 3 For 5 s", ["logic CheckValue", "topic /odom", "rate 3", "logic For", "rate 5", "rate s"]],
  ['"unfinished\nIfThen( Iffy Off', ['string "unfinished', "keyword If", "keyword Then", "rate Off"]],
])("in %j is coloured %j", (text, coloured) => {
  expect([...colouredIn(text)].map(({ from, to, colour }) => `${colour} ${text.slice(from, to)}`)).toEqual(coloured);
});
