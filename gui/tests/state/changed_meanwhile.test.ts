// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from "vitest";
import { ImportDraft } from "../../src/panels/sharing";
import { openRules } from "./served";

const PREVIEW = {
  document: { collections: [{ statements: [{ kind: "set", id: "1" }] }], findings: [], parses: true },
  conflicts: [],
};
const imported = ({ text = "" }) => ({ text: `${text}// imported\n`, document: PREVIEW.document });
afterEach(() => vi.unstubAllGlobals());

/** An import of another file into rules that are open, with its dialog open. */
async function importing(disk: { text: string }) {
  const editor = await openRules(disk, { "POST /api/import/preview": () => PREVIEW, "POST /api/import": imported });
  const draft = new ImportDraft(editor);
  await draft.readDisk(new File(["begin\nend\n"], "b.adirf"));
  return { editor, draft };
}

test("an import takes nothing from a file that somebody changed while its dialog was open", async () => {
  const disk = { text: "begin\nend\n" };
  const { editor, draft } = await importing(disk);
  disk.text = "begin\n// theirs\nend\n";
  await editor.lookAtDisk();
  expect(await draft.take()).toBe(false);
  expect([editor.text.value, draft.problem.value]).toEqual([
    disk.text,
    "a.adirf was changed since this was opened, so nothing was imported: close it and import again",
  ]);
});

test("an import into the rules that its dialog was opened on is done", async () => {
  const { editor, draft } = await importing({ text: "begin\nend\n" });
  expect(await draft.take()).toBe(true);
  expect([editor.text.value, editor.message.value]).toEqual(["begin\nend\n// imported\n", "Imported 1 of b.adirf"]);
});

test("what is typed while the text is being formatted stays", async () => {
  let answer = (_: string) => {};
  const formatted = new Promise((resolve) => (answer = (text) => resolve({ text })));
  const format = vi.fn(() => formatted);
  const editor = await openRules({ text: "begin  end\n" }, { "POST /api/format": format });
  const done = editor.format();
  await vi.waitFor(() => expect(format).toHaveBeenCalled());
  editor.type("begin  end\n// typed\n");
  answer("begin end\n");
  await done;
  await editor.check();
  expect([editor.text.value, editor.message.value]).toEqual(["begin  end\n// typed\n", ""]);
});
