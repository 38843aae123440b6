// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ReadonlySignal } from "@preact/signals";
import type { Api } from "../api/client";
import { ProfileEditor } from "./profile_editor";
import { RuleEditor } from "./rule_editor";

/** The files that were opened: what is not saved is still there when somebody comes back to it. */
export class OpenEditors {
  private readonly rules = new Map<string, RuleEditor>();
  private readonly profiles = new Map<string, ProfileEditor>();

  /** The editor of a rule file: the one with unsaved changes, else a new one. */
  of(api: Api, name: string): RuleEditor {
    return unsavedOrNew(this.rules, name, () => new RuleEditor(api, name));
  }

  /** The editor of a profile: the one with unsaved changes, else a new one. */
  profileOf(api: Api, name: string): ProfileEditor {
    return unsavedOrNew(this.profiles, name, () => new ProfileEditor(api, name));
  }

  /** The files with changes that are on this page only; a new one may not be on disk yet. */
  unsaved(kind: "rules" | "profile"): string[] {
    return [...this[kind === "rules" ? "rules" : "profiles"]]
      .filter(([, editor]) => !editor.isSaved.value)
      .map(([name]) => name);
  }

  get hasUnsaved(): boolean {
    return this.unsaved("rules").length + this.unsaved("profile").length > 0;
  }
}

function unsavedOrNew<T extends { isSaved: ReadonlySignal<boolean> }>(
  editors: Map<string, T>,
  name: string,
  create: () => T,
): T {
  const known = editors.get(name);
  if (known && !known.isSaved.peek()) return known;
  const editor = create();
  editors.set(name, editor);
  return editor;
}
