// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { signal } from "@preact/signals";
import type { Api, Rules } from "../api/client";
import type { RuleDocument, Vocabulary } from "../api/types";
import { topicsIn } from "./statements";

const KEPT_MS = 5000;

interface Known {
  rules: Rules;
  key: string;
  askedMs: number;
  vocabulary: Vocabulary;
}

/** What to suggest; asked for when the rules name other topics than before, or a robot may have others by now. */
export class Words {
  readonly vocabulary = signal<Vocabulary | null>(null);
  private known: Known | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly api: Api) {}

  /** What to suggest beside these rules. */
  async of(rules: Rules, document: Promise<RuleDocument>): Promise<Vocabulary> {
    const askedMs = performance.now();
    // The first time there is nothing to compare, and no reason to wait.
    const first = this.known === null ? this.ask(rules) : null;
    first?.catch(() => undefined);
    const key = JSON.stringify([rules.profile_text, [...topicsIn(await document)].sort()]);
    if (key !== this.known?.key || askedMs - this.known.askedMs >= KEPT_MS) {
      this.known = { rules, key, askedMs, vocabulary: await (first ?? this.ask(rules)) };
    }
    return this.known.vocabulary;
  }

  /** The words for somebody to choose from; they are asked for once more, as soon as they are 5 s old. */
  offered(): Vocabulary | null {
    if (this.known !== null && this.timer === undefined) {
      const dueMs = this.known.askedMs + KEPT_MS - performance.now();
      this.timer = setTimeout(() => void this.renew(), Math.max(0, dueMs));
    }
    return this.vocabulary.value;
  }

  private async renew(): Promise<void> {
    const { known } = this;
    this.timer = undefined;
    if (known === null) return;
    const askedMs = performance.now();
    // The top of the page says where a server does not answer.
    const vocabulary = await this.ask(known.rules).catch(() => null);
    if (vocabulary === null || known !== this.known) return;
    const isSame = JSON.stringify(vocabulary) === JSON.stringify(known.vocabulary);
    this.known = { ...known, askedMs, vocabulary: isSame ? known.vocabulary : vocabulary };
    // The same words again would be offered anew, and so be asked for without end.
    if (!isSame) this.vocabulary.value = vocabulary;
  }

  private ask({ text, profile_text }: Rules): Promise<Vocabulary> {
    return this.api.ask("POST /api/vocabulary", { text, profile_text });
  }
}
