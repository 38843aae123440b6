// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { signal } from "@preact/signals";
import type { ProfileFix, ProfileRow, ProfileTable } from "../api/types";
import type { RuleEditor } from "./rule_editor";

/** What was done to the topic parameters, and what takes it back. */
interface ProfileChange {
  words: string;
  takeBack(): Promise<void>;
}

/** What the text of a profile becomes. */
type Edited = (name: string, text: string) => Promise<string>;

/** Changes of the topic parameters that findings and the optimizer ask for: said, saved, and possible to take back. */
export class ProfileRepair {
  /** The last change, until it is taken back or put away. */
  readonly done = signal<ProfileChange | null>(null);

  constructor(private readonly editor: RuleEditor) {}

  /** Writes one entry. */
  mend({ topic, key, value }: ProfileFix): Promise<void> {
    const words = (name: string) =>
      value === null ? `Took ${key} of ${topic} out of ${name}` : `Added ${key} = ${value} for ${topic} to ${name}`;
    return this.change(
      words,
      async (name, text) =>
        (await this.editor.api.ask("POST /api/profile/entry", { name, text, topic, key, value })).text,
    );
  }

  /** Fills what the table lacks, and nothing else, with what a recording says of the topics of the rules. */
  measureMissing(bag: string, topics: ReadonlySet<string>): Promise<void> {
    const words = (name: string) => `Added what ${bag} says of the rules' topics to ${name}`;
    return this.change(words, async (name, text) => {
      const table = await this.editor.api.ask("POST /api/profile/parse", { name, text });
      const recorded = await this.editor.api.ask("POST /api/profile/measure", { bag });
      const measured = await this.editor.api.ask("POST /api/profile/parse", { name, text: recorded.text });
      const own = new Map(table.rows.map((row) => [row.topic, row]));
      for (const row of measured.rows) {
        if (topics.has(row.topic)) own.set(row.topic, filled(own.get(row.topic), row));
      }
      return this.written(name, text, { ...table, rows: [...own.values()] });
    });
  }

  /** Sets the budget, and keeps everything else in the file. */
  setBudget(budget_kb_per_s: number): Promise<void> {
    return this.rewrite(
      async (name, text) => {
        const table = await this.editor.api.ask("POST /api/profile/parse", { name, text });
        return this.written(name, text, { ...table, budget_kb_per_s });
      },
      (name) => (this.editor.message.value = `Saved ${name}: ${budget_kb_per_s} KB/s`),
    );
  }

  private change(words: (name: string) => string, edited: Edited): Promise<void> {
    return this.rewrite(edited, (name, before, hash) => {
      this.done.value = { words: words(name), takeBack: () => this.takeBack(name, before, hash) };
    });
  }

  /** Saves what `edited` makes of the file, and tells `saved` with the text of before and the hash of now. */
  private async rewrite(edited: Edited, saved: (name: string, before: string, hash: string) => void): Promise<void> {
    const name = this.editor.profile.peek()?.name;
    if (name === undefined) return;
    await this.editor.inTurn(async () => {
      const before = await this.editor.api.read(name);
      const { hash } = await this.editor.api.save(name, await edited(name, before.text), before.hash);
      saved(name, before.text, hash);
      await this.editor.useProfile(name);
    });
  }

  private async written(name: string, base_text: string, table: ProfileTable): Promise<string> {
    return (await this.editor.api.ask("POST /api/profile/write", { ...table, name, base_text })).text;
  }

  /** Writes the text of before; where somebody else changed the file meanwhile, that is refused and told. */
  private takeBack(name: string, text: string, hash: string): Promise<void> {
    return this.editor.inTurn(async () => {
      await this.editor.api.save(name, text, hash);
      this.done.value = null;
      this.editor.message.value = `${name} is as it was before`;
      await this.editor.useProfile(name);
    });
  }
}

/** A row with what another one says where it says nothing. */
function filled(own: ProfileRow | undefined, other: ProfileRow): ProfileRow {
  const said = Object.entries(own ?? {}).filter(([, value]) => value !== null && value !== undefined);
  return { ...other, ...Object.fromEntries(said) };
}
