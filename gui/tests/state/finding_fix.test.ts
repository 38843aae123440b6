// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from "vitest";
import type { PlacedFinding } from "../../src/api/types";
import { openRules } from "./served";

afterEach(() => vi.unstubAllGlobals());

const WRONG = "SetFrequenzy";
const RIGHT = "SetFrequency";

/** Rules with a wrong word, on a server that finds it wherever it stands. */
async function misspelt() {
  const findings = (text: string) => {
    const offset = text.indexOf(WRONG);
    return offset < 0 ? [] : [{ code: "expected-statement", offset, fix: { title: RIGHT, edit: { offset } } }];
  };
  const editor = await openRules(
    { text: `begin ${WRONG} /odom 5 end` },
    {
      "POST /api/document": ({ text = "" }) => ({ collections: [], findings: findings(text), parses: true }),
      "POST /api/edit": ({ text = "" }) => {
        const edited = text.replace(WRONG, RIGHT);
        return { text: edited, document: { collections: [], findings: findings(edited), parses: true } };
      },
    },
  );
  return { editor, finding: editor.findings.peek()[0] as PlacedFinding };
}

test("a fix is done though the text was read again since the finding was shown", async () => {
  const { editor, finding } = await misspelt();
  editor.type(`${editor.text.value} // later`);
  await editor.fix(finding);
  expect(editor.text.value).toBe(`begin ${RIGHT} /odom 5 end // later`);
  expect(editor.findings.value).toEqual([]);
});

test("a fix of what is no longer there changes nothing, and that is said", async () => {
  const { editor, finding } = await misspelt();
  editor.type(`// first\n${editor.text.value}`);
  await editor.fix(finding);
  expect(editor.text.value).toBe(`// first\nbegin ${WRONG} /odom 5 end`);
  expect(editor.message.value).toContain("nothing was mended: try again");
});
