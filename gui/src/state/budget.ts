// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Api } from "../api/client";
import type { RuleEditor } from "./rule_editor";

/** Sets the budget in the file of an editor's topic parameters, and keeps everything else in it. */
export async function setBudget(api: Api, editor: RuleEditor, budgetKbPerS: number): Promise<void> {
  const name = editor.profile.peek()?.name;
  if (name === undefined) return;
  await editor.inTurn(async () => {
    const { text, hash } = await api.read(name);
    const table = await api.parseProfile(name, text);
    const written = await api.writeProfile(name, { ...table, budget_kb_per_s: budgetKbPerS }, text);
    await api.save(name, written.text, hash);
    editor.message.value = `Saved ${name}: ${budgetKbPerS} KB/s`;
    await editor.useProfile(name);
  });
}
