// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from "vitest";
import { Api } from "../../src/api/client";
import { PLAIN_GRID } from "../../src/state/layout";
import { ProfileEditor } from "../../src/state/profile_editor";
import { draftsIn, openRules, serve, storage } from "./served";

afterEach(() => vi.unstubAllGlobals());
const draft = (content: unknown) => ({ content: JSON.stringify(content), hash: "old", changedMs: 1 });

test("what was restored of a rule file that is gone can be dropped", async () => {
  const kept = storage();
  draftsIn(kept).keep("rules", "a.adirf", draft({ text: "begin\n// mine\nend\n", map: PLAIN_GRID }));
  const editor = await openRules({ text: null }, {}, kept);
  expect([editor.restored.value === null, editor.text.value]).toEqual([false, "begin\n// mine\nend\n"]);
  await editor.dropRestored();
  expect([editor.restored.value, editor.text.value, editor.isSaved.value, kept.length]).toEqual([null, "", true, 0]);
});

test("what was restored of a table that is gone can be dropped, and undo brings it back", async () => {
  const kept = storage();
  const cells = { message_kb: "3", priority: "", source_hz: "", min_hz: "", max_hz: "", tiers_hz: Array(6).fill("") };
  const accuracies = { tiers_m: null, tiers_deg: null, tiers_rad: null };
  const needs = { tiers_m_need_hz: null, tiers_deg_need_hz: null, tiers_rad_need_hz: null };
  const row = { key: 0, topic: "/scan", type: null, ...cells, accuracies: { ...accuracies, ...needs } };
  draftsIn(kept).keep("profile", "lte.toml", draft({ rows: [row], budget: "9", baseText: "" }));
  serve({ "GET /api/file": () => new Response("{}", { status: 404 }) });
  const editor = new ProfileEditor(new Api(), "lte.toml", draftsIn(kept));
  await editor.open([]);
  const topics = () => editor.rows.value.map(({ topic }) => topic);
  expect([editor.restored.value === null, topics()]).toEqual([false, ["/scan"]]);
  await editor.dropRestored();
  expect([editor.restored.value, topics(), editor.isSaved.value, kept.length]).toEqual([null, [""], true, 0]);
  editor.undo();
  expect(topics()).toEqual(["/scan"]);
});
