// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Api } from "../api/client";
import { RuleEditor } from "./rule_editor";

/** The rule files that were opened: what is not saved is still there when somebody comes back to it. */
export class OpenEditors {
  private readonly editors = new Map<string, RuleEditor>();

  /** The editor of a file: the one with unsaved changes, else a new one. */
  of(api: Api, name: string): RuleEditor {
    const known = this.editors.get(name);
    if (known && !known.isSaved.peek()) return known;
    const editor = new RuleEditor(api, name);
    this.editors.set(name, editor);
    return editor;
  }

  /** Whether a file has changes that are on this page only. */
  isUnsaved(name: string): boolean {
    return this.editors.get(name)?.isSaved.value === false;
  }

  get hasUnsaved(): boolean {
    return [...this.editors.values()].some((editor) => !editor.isSaved.peek());
  }
}
