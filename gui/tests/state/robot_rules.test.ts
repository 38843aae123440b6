// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
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
