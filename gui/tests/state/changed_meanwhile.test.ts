// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from "vitest";
import { openRules } from "./served";

afterEach(() => vi.unstubAllGlobals());

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
