// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from "vitest";
import { type Optimized, optimized } from "../../src/panels/rate_budget";
import { openRules, refused } from "../state/served";

afterEach(() => vi.unstubAllGlobals());

/** Rules with two profiles, of which the optimizer answers when the test says so. */
async function optimizing() {
  const answers = new Map<string, (answer: unknown) => void>();
  const editor = await openRules(
    { text: "begin\nend\n" },
    {
      "GET /api/file": ({ name = "" }) => ({
        name,
        text: name === "a.adirf" ? "begin\nend\n" : `# ${name}`,
        hash: "1",
      }),
      "POST /api/optimize": ({ text, profile_text }) =>
        new Promise((resolve) => answers.set(`${text}${profile_text}`, resolve)),
    },
  );
  const told: Optimized[] = [];
  const ask = () => optimized(editor, (answer) => told.push(answer));
  return { editor, told, ask, answer: (about: string, answer: unknown) => answers.get(about)?.(answer) };
}

test.each([
  ["an answer", () => ({ budget_kb_per_s: 1 })],
  ["a refusal", () => refused(422)],
])("%s about other topic parameters comes too late", async (_, former) => {
  const { editor, told, ask, answer } = await optimizing();
  await editor.useProfile("one.toml");
  const aboutOne = ask();
  await editor.useProfile("two.toml");
  const aboutTwo = ask();
  answer("begin\nend\n# two.toml", { budget_kb_per_s: 2 });
  await aboutTwo;
  answer("begin\nend\n# one.toml", former());
  await aboutOne;
  expect(told).toEqual([{ budget_kb_per_s: 2, text: "begin\nend\n", profile_text: "# two.toml" }]);
});

test("an answer about a text of before comes too late, and one about that of now is told", async () => {
  const { editor, told, ask, answer } = await optimizing();
  await editor.useProfile("one.toml");
  const former = ask();
  editor.type("begin\n// new\nend\n");
  await editor.check();
  answer("begin\nend\n# one.toml", refused(422));
  await former;
  expect(told).toEqual([]);
  const latter = ask();
  answer("begin\n// new\nend\n# one.toml", refused(422));
  await latter;
  expect(told).toMatchObject([{ refused: "Refused with 422", text: "begin\n// new\nend\n" }]);
});
