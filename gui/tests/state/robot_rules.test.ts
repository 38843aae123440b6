// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { signal } from "@preact/signals";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { Api } from "../../src/api/client";
import { RobotRules } from "../../src/state/robot_rules";
import { RuleEditor } from "../../src/state/rule_editor";
import { draftsIn, fileAnswers, serve } from "./served";
import { linkOf, robotOf } from "./told_robots";

const RULES = "begin\nend\n";
const LONG_MS = 5000;
beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

test.each(["GET /api/file", "POST /api/profile/for"])("rules are compared only once %s is answered", async (late) => {
  const compared = vi.fn((_: Record<string, string>) => ({ same: true }));
  const answers = {
    ...fileAnswers("a.adirf", { text: RULES }),
    "POST /api/document": () => ({ collections: [], findings: [], parses: true }),
    "POST /api/profile/for": () => ({ name: null, gone: null }),
    "POST /api/push/preview": compared,
  };
  const answer = answers[late as keyof typeof answers] as (asked: Record<string, string>) => unknown;
  const after = (asked: Record<string, string>) =>
    new Promise((done) => setTimeout(() => done(answer(asked)), LONG_MS));
  const link = linkOf(robotOf("/ada"));
  serve({ ...answers, [late]: after });
  const editor = new RuleEditor(new Api(), "a.adirf", draftsIn());
  const stop = new RobotRules(editor, link).follow();
  const opened = editor.open();
  await vi.advanceTimersByTimeAsync(LONG_MS - 1);
  expect(compared).not.toHaveBeenCalled();
  await vi.advanceTimersByTimeAsync(LONG_MS);
  await opened;
  stop();
  expect(compared.mock.calls.map(([{ text }]) => text)).toEqual([RULES]);
});

test("an edit leaves the states on the rules that the robot has, and marks those that it has otherwise", async () => {
  const rule = (id: string, key: string, value: number) => ({
    // biome-ignore lint/suspicious/noThenProperty: as the server writes it
    ...{ kind: "rule", id, key, name: id, label: id, priority: 0, is_disabled: false, then: [], else: [], line: 1 },
    condition: { kind: "check", topic: "/odom", property: "pose_x", op: ">", value },
  });
  const documents = {
    [RULES]: [rule("s1", "a", 1), rule("s2", "b", 2)],
    [`${RULES}// b\n`]: [rule("s1", "a", 1), rule("s2", "B", 3)],
  };
  const differing = { [RULES]: [], [`${RULES}// b\n`]: [1] };
  const link = linkOf(robotOf("/ada"));
  serve({
    ...fileAnswers("a.adirf", { text: RULES }),
    "POST /api/document": ({ text = "" }) => ({
      ...{ findings: [], parses: true },
      collections: [{ statements: documents[text as keyof typeof documents] ?? [] }],
    }),
    "POST /api/profile/for": () => ({ name: null, gone: null }),
    "POST /api/push/preview": ({ text = "" }) => ({
      same: text === RULES,
      differing_rules: differing[text as keyof typeof differing],
    }),
  });
  const editor = new RuleEditor(new Api(), "a.adirf", draftsIn());
  const block = { state: "true", checks: [], times: [] };
  const live = { status: { blocks: [block, block] }, labels: ["s1", "s2"], checks: [] };
  Object.assign(link, { calm: signal(live) });
  const robotRules = new RobotRules(editor, link);
  const stop = robotRules.follow();
  await editor.open();
  await vi.advanceTimersByTimeAsync(LONG_MS);
  const seen = () => [[...robotRules.states.value.keys()], [...robotRules.differing.value]];
  expect(seen()).toEqual([["s1", "s2"], []]);
  editor.type(`${RULES}// b\n`);
  await vi.advanceTimersByTimeAsync(LONG_MS);
  expect(seen()).toEqual([["s1"], ["s2"]]);
  stop();
});
