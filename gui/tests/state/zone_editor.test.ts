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

test("a rectangle that is drawn anew takes the place of that of its rule", async () => {
  const old = { min_x_m: 5, max_x_m: 9, min_y_m: 5, max_y_m: 9 };
  const zone = (rectangle: object) => ({ topic: "/odom", rectangle, is_shared: false });
  const rule = { id: "s1", label: "Bay", others: [], holds_elsewhere: false, is_too_mixed: false };
  const rules = [{ ...rule, zones: [zone({ ...old, min_x_m: 6 }), zone(old)] }];
  const edit = vi.fn(() => ({ text: "begin\nend\n// moved\n", document: READ }));
  const answers = { "POST /api/zones": () => ({ ...ZONES, rules }), "POST /api/edit": edit };
  const editor = await openRules({ text: "begin\nend\n" }, answers);
  const zones = new ZoneEditor(editor);
  zones.follow();
  await vi.waitFor(() => expect(zones.rules.value).toHaveLength(1));
  zones.redraw("s1", old);
  await zones.draw(SQUARE);
  const rectangle = { min_x_m: 0, max_x_m: 1, min_y_m: 0, max_y_m: 1 };
  expect(edit.mock.calls[0]).toMatchObject([{ edits: [{ kind: "zone_resize", id: "s1", index: 1, rectangle }] }]);
  expect([zones.draft.value, zones.redrawn.value]).toEqual([null, null]);
  await zones.draw(SQUARE);
  expect(zones.draft.value?.rectangles).toEqual([rectangle]);
});

test("a zone is added to a rule only where the map shows the text of now", async () => {
  const { editor, zones, edit } = await drawn();
  await zones.add("/odom", "Bay", "1");
  expect(edit).not.toHaveBeenCalled();
  expect([editor.text.value, zones.draft.value === null]).toEqual(["begin\nend\n", false]);
});
