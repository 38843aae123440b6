// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Api, type Rules, refusal } from "../api/client";
import type { OptimizeAnswer } from "../api/types";
import type { RuleEditor } from "./rule_editor";

/** What was asked about: repairs are edits of its text. */
type Asked = Pick<Rules, "text" | "profile_text">;
/** What the optimizer says of rules, or why it refuses them. */
export type Optimized = Asked & (OptimizeAnswer | { refused: string });

/** Asks the optimizer about the rules of now; an answer that comes when they are other ones is not told. */
export async function optimized(editor: RuleEditor, api: Api, tell: (answer: Optimized) => void): Promise<void> {
  const { rules } = editor;
  const { text, profile_text } = rules;
  const answer = await api.ask("POST /api/optimize", rules).catch((error: unknown) => ({ refused: refusal(error) }));
  const now = editor.rules;
  if (text === now.text && profile_text === now.profile_text) tell({ ...answer, text, profile_text });
}
