// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type ReadonlySignal, signal } from "@preact/signals";
import type { Api } from "../api/client";
import type { FileAnswer } from "../api/types";
import type { Drafts } from "./drafts";
import { ProfileEditor } from "./profile_editor";
import { type LostChanges, RuleEditor } from "./rule_editor";
import { Folds } from "./statements";
import { Tries } from "./tries";

/** The files that were opened: what is not saved is still there when somebody comes back to it. */
export class OpenEditors {
  readonly tries = new Tries();
  /** What was left in blocks last and did not come into the text, until somebody read it. */
  readonly lost = signal<LostChanges | null>(null);
  /** What was deleted here and not brought back, the last one at the end. */
  readonly deleted = signal<readonly FileAnswer[]>([]);
  private readonly rules = new Map<string, RuleEditor>();
  private readonly profiles = new Map<string, ProfileEditor>();

  private readonly folds = new Map<string, Folds>();

  constructor(
    private readonly api: Api,
    private readonly drafts: Drafts,
  ) {}

  /** The editor of a rule file: the one with unsaved changes, else a new one. */
  of(name: string): RuleEditor {
    const folds = this.folds.get(name) ?? new Folds();
    this.folds.set(name, folds);
    return unsavedOrNew(this.rules, name, () => new RuleEditor(this.api, name, this.drafts, folds, this.lost));
  }

  /** What is not saved of a rule file that is open; null where nothing is. */
  unsavedText(name: string): string | null {
    const known = this.rules.get(name);
    return known && !known.isSaved.peek() ? known.text.peek() : null;
  }

  /** The editor of a profile: the one with unsaved changes, else a new one. */
  profileOf(name: string): ProfileEditor {
    return unsavedOrNew(this.profiles, name, () => new ProfileEditor(this.api, name, this.drafts));
  }

  /** The files with changes that are in this browser only; a new one may not be on disk yet. */
  unsaved(kind: "rules" | "profile"): string[] {
    const open = [...this[kind === "rules" ? "rules" : "profiles"]].filter(([, editor]) => !editor.isSaved.value);
    return [...new Set([...open.map(([name]) => name), ...this.drafts.names(kind)])];
  }

  /** Whether a reload would lose something: it is not saved, and the browser keeps no draft of it. */
  get wouldLose(): boolean {
    return !this.drafts.hasRoom && this.unsaved("rules").length + this.unsaved("profile").length > 0;
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
