// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { signal } from "@preact/signals";
import type { Api } from "../api/client";
import type { ProfileFix, ProfileRow } from "../api/types";
import type { RuleEditor } from "./rule_editor";

/** What was done to the topic parameters, and what takes it back. */
interface ProfileChange {
  words: string;
  takeBack(): Promise<void>;
}

/** Changes of the topic parameters that findings and the optimizer ask for: said, saved, and possible to take back. */
export class ProfileRepair {
  /** The last change, until it is taken back or put away. */
  readonly done = signal<ProfileChange | null>(null);

  constructor(
    private readonly api: Api,
    private readonly editor: RuleEditor,
  ) {}

  /** Writes one entry. */
  mend({ topic, key, value }: ProfileFix): Promise<void> {
    const words = (name: string) =>
      value === null ? `Took ${key} of ${topic} out of ${name}` : `Added ${key} = ${value} for ${topic} to ${name}`;
    return this.change(
      words,
      async (name, text) => (await this.api.ask("POST /api/profile/entry", { name, text, topic, key, value })).text,
    );
  }

  /** Fills what the table lacks, and nothing else, with what a recording says of the topics of the rules. */
  measureMissing(bag: string, topics: ReadonlySet<string>): Promise<void> {
    const words = (name: string) => `Added what ${bag} says of the rules' topics to ${name}`;
    return this.change(words, async (name, text) => {
      const [table, measured] = [
        await this.api.parseProfile(name, text),
        await this.api.parseProfile(name, (await this.api.measureProfile(bag)).text),
      ];
      const own = new Map(table.rows.map((row) => [row.topic, row]));
      for (const row of measured.rows) {
        if (topics.has(row.topic)) own.set(row.topic, filled(own.get(row.topic), row));
      }
      return (await this.api.writeProfile(name, { ...table, rows: [...own.values()] }, text)).text;
    });
  }

  private async change(
    words: (name: string) => string,
    edited: (name: string, text: string) => Promise<string>,
  ): Promise<void> {
    const name = this.editor.profile.peek()?.name;
    if (name === undefined) return;
    await this.editor.inTurn(async () => {
      const before = await this.api.read(name);
      const text = await edited(name, before.text);
      const { hash } = await this.api.save(name, text, before.hash);
      const takeBack = () => this.takeBack(name, before.text, hash);
      this.done.value = { words: words(name), takeBack };
      await this.editor.useProfile(name);
    });
  }

  /** Writes the text of before; where somebody else changed the file meanwhile, that is refused and told. */
  private takeBack(name: string, text: string, hash: string): Promise<void> {
    return this.editor.inTurn(async () => {
      await this.api.save(name, text, hash);
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
