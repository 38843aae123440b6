// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type ReadonlySignal, signal } from "@preact/signals";
import { type Api, refusalOf } from "../api/client";
import type { FileAnswer } from "../api/types";
import type { LocalDrafts } from "./drafts";
import { ProfileEditor } from "./profile_editor";
import { type LostChanges, RuleEditor } from "./rule_editor";
import { Folds } from "./statements";
import { sentKbPerS } from "./trial";
import { Tries } from "./tries";

/** The files that were opened: what is not saved is still there when somebody comes back to it. */
export class OpenEditors {
  /** The server keeps what the last try said, for the list of files. */
  readonly tries = new Tries((name, bag, said) => {
    const tried = { name, bag, kb_per_s: sentKbPerS(said) ?? 0, percent: said.percent };
    if (this.drafts.canSend()) void refusalOf(() => this.api.ask("PUT /api/file/tried", tried));
  });
  /** What was left in blocks last and did not come into the text, until somebody read it. */
  readonly lost = signal<LostChanges | null>(null);
  /** What was deleted here and not brought back, the last one at the end. */
  readonly deleted = signal<readonly FileAnswer[]>([]);
  private readonly rules = new Map<string, RuleEditor>();
  private readonly profiles = new Map<string, ProfileEditor>();

  private readonly folds = new Map<string, Folds>();

  constructor(
    private readonly api: Api,
    private readonly drafts: LocalDrafts,
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

  /** The files with changes that only this page or this browser has; a new one may not be on disk yet. */
  unsaved(): string[] {
    const open = [...this.rules, ...this.profiles].filter(([, editor]) => !editor.isSaved.value);
    return [...open.map(([name]) => name), ...this.drafts.names()];
  }

  /** Gives up what is not saved of a file; of rules a version is kept. */
  async discard(name: string): Promise<void> {
    const open = this.rules.get(name) ?? this.profiles.get(name);
    if (open?.isOpen.peek() && !open.isSaved.peek()) return open.discard();
    const { draft } = await this.api.draft(name);
    const known_ids = draft === null ? [] : [draft.id];
    const asked = { name, root_hash: this.drafts.project, id: "", known_ids, draft: null };
    for (const each of [this.drafts.takeOver(name), draft])
      if (each !== null) await this.api.ask("PUT /api/draft", { ...asked, discarded: each.content });
    this.drafts.drop(name);
  }

  /** Whether a reload would lose something: the server has no draft of it yet, and the browser has no room for one. */
  get wouldLose(): boolean {
    return !this.drafts.hasRoom && [...this.rules, ...this.profiles].some(([, editor]) => !editor.isKept);
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
