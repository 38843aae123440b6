// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { RuleEditor } from "../state/rule_editor";

/** Marks the statement that holds a line, in the text and on the blocks; null marks nothing. */
export function showInEditor(editor: RuleEditor, line: number | null): void {
  const statements = editor.document.peek().collections.flatMap((collection) => collection.statements);
  const found = line === null ? undefined : statements.findLast((each) => (each.line ?? 0) <= line);
  const { offset, end_offset } = found ?? {};
  const isKnown = offset !== undefined && end_offset !== undefined;
  editor.spot.value = isKnown ? { offset, end_offset, from: "try" } : null;
}
