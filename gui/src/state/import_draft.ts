// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { batch, computed, signal } from "@preact/signals";
import { type Api, ApiError, type TextFile } from "../api/client";
import type { EditAnswer, ImportConflict, ImportPreview, PlacedFinding } from "../api/types";
import { FileProblem, fileText } from "../ui/files";
import type { RuleEditor } from "./rule_editor";

/** An import that is being put together: the other file, what of it shall come, and what that leads to. */
export class ImportDraft {
  readonly source = signal<TextFile | null>(null);
  readonly preview = signal<ImportPreview | null>(null);
  readonly chosen = signal<ReadonlySet<string>>(new Set());
  readonly replacing = signal<ReadonlySet<string>>(new Set());
  readonly problem = signal("");
  /** The file as it would be; null while the server thinks. */
  private readonly outcome = signal<EditAnswer | null>(null);
  readonly statements = computed(
    () => this.preview.value?.document.collections.flatMap((collection) => collection.statements) ?? [],
  );
  readonly newFindings = computed(() => {
    if (this.chosen.value.size === 0) return [];
    return this.outcome.value && added(this.before, this.outcome.value.document.findings);
  });
  private readonly rules;
  private readonly before: readonly PlacedFinding[];

  constructor(
    private readonly api: Api,
    private readonly editor: RuleEditor,
  ) {
    this.rules = editor.rules;
    this.before = editor.document.peek().findings;
  }

  /** Reads another file of the project. */
  readProject(name: string): Promise<void> {
    return this.read(() => this.api.read(name));
  }

  /** Reads a file of the user's disk. */
  readDisk(file: File): Promise<void> {
    return this.read(() => fileText(file));
  }

  conflict(id: string): ImportConflict | undefined {
    return this.preview.value?.conflicts.find((each) => each.id === id);
  }

  choose(chosen: ReadonlySet<string>): void {
    this.chosen.value = chosen;
    void this.work();
  }

  /** Whether a statement shall take the place of the one of the same name. */
  replace(id: string, isWanted: boolean): void {
    const next = new Set(this.replacing.value);
    if (isWanted) next.add(id);
    else next.delete(id);
    this.replacing.value = next;
    void this.work();
  }

  /** Does the import, as one step of undo; false where it could not be done. */
  async take(): Promise<boolean> {
    await this.work();
    const outcome = this.outcome.value;
    if (outcome === null) return false;
    if (this.editor.text.peek() !== this.rules.text) {
      this.problem.value = `${this.rules.name} was changed since this was opened, so nothing was imported: close it and import again`;
      return false;
    }
    const count = this.chosen.value.size;
    await this.editor.setText(outcome.text);
    this.editor.message.value = `Imported ${count} of ${this.source.value?.name ?? ""}`;
    return true;
  }

  private async read(source: () => Promise<TextFile>): Promise<void> {
    await this.try(async () => {
      const file = await source();
      const preview = await this.api.ask("POST /api/import/preview", {
        text: this.rules.text,
        name: this.rules.name,
        other_text: file.text,
        other_name: file.name,
      });
      const same = new Set(preview.conflicts.filter((each) => each.is_same).map(({ id }) => id));
      const all = preview.document.collections.flatMap((collection) => collection.statements);
      batch(() => {
        this.source.value = file;
        this.preview.value = preview;
        this.replacing.value = new Set();
        this.problem.value = all.length === 0 ? `${file.name} holds no rules` : "";
      });
      const coming = all.filter((each) => each.kind !== "raw" && !same.has(each.id ?? ""));
      this.choose(new Set(coming.map((each) => each.id ?? "")));
    });
  }

  /** Asks what the file would be; an answer about a choice of the past is dropped. */
  private async work(): Promise<void> {
    const [source, chosen, replacing] = [this.source.value, this.chosen.value, this.replacing.value];
    this.outcome.value = null;
    if (source === null || chosen.size === 0) return;
    await this.try(async () => {
      const replace_ids = [...replacing].filter((id) => chosen.has(id));
      const answer = await this.api.ask("POST /api/import", {
        ...this.rules,
        other_text: source.text,
        ids: [...chosen],
        replace_ids,
      });
      if (chosen === this.chosen.value && replacing === this.replacing.value) this.outcome.value = answer;
    });
  }

  private async try(work: () => Promise<void>): Promise<void> {
    try {
      await work();
    } catch (error) {
      if (!(error instanceof ApiError || error instanceof FileProblem)) throw error;
      this.problem.value = error.message;
    }
  }
}

/** The findings that were not there before, wherever they stand now. */
function added(before: readonly PlacedFinding[], after: readonly PlacedFinding[]): PlacedFinding[] {
  const known = new Map<string, number>();
  const word = ({ code, message }: PlacedFinding) => `${code} ${message}`;
  for (const finding of before) known.set(word(finding), (known.get(word(finding)) ?? 0) + 1);
  return after.filter((finding) => {
    const count = known.get(word(finding)) ?? 0;
    known.set(word(finding), count - 1);
    return count <= 0;
  });
}
