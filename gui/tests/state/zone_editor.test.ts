// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from "vitest";
import { ZoneEditor } from "../../src/state/zone_editor";
import { openRules } from "./served";

const SQUARE = { kind: "rectangle", sides: [0, 0, 1, 1] } as const;
const READ = { collections: [], findings: [], parses: true };
const ZONES = { rules: [], clashes: [], label: "Zone 1" };
afterEach(() => vi.unstubAllGlobals());

/** A map on which a square is drawn before the server said what zones there are. */
async function drawn() {
  const edit = vi.fn(({ text = "" }) => ({ text: `${text}// zone\n`, document: READ }));
  const editor = await openRules({ text: "begin\nend\n" }, { "POST /api/zones": () => ZONES, "POST /api/edit": edit });
  const zones = new ZoneEditor(editor);
  await zones.draw(SQUARE);
  return { editor, zones, edit };
}

test("a new zone is added though the map does not know the zones of the text yet", async () => {
  const { editor, zones } = await drawn();
  await zones.add("/odom", "Zone 1", null);
  expect([editor.text.value, zones.draft.value]).toEqual(["begin\nend\n// zone\n", null]);
});

test("a zone is added to a rule only where the map shows the text of now", async () => {
  const { editor, zones, edit } = await drawn();
  await zones.add("/odom", "Bay", "1");
  expect(edit).not.toHaveBeenCalled();
  expect([editor.text.value, zones.draft.value === null]).toEqual(["begin\nend\n", false]);
});
