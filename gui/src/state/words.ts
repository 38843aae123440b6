// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Api, Rules } from "../api/client";
import type { RuleDocument, Vocabulary } from "../api/types";
import { topicsIn } from "./statements";

const KEPT_MS = 5000;

/** What to suggest; asked for when the rules name other topics than before, or a robot may have others by now. */
export class Words {
  private known: { key: string; askedMs: number; vocabulary: Vocabulary } | null = null;

  constructor(private readonly api: Api) {}

  async of({ text, profile_text }: Rules, document: Promise<RuleDocument>): Promise<Vocabulary> {
    const askedMs = performance.now();
    // The first time there is nothing to compare, and no reason to wait.
    const first = this.known === null ? this.api.vocabulary(text, profile_text) : null;
    first?.catch(() => undefined);
    const key = JSON.stringify([profile_text, [...topicsIn(await document)].sort()]);
    if (key !== this.known?.key || askedMs - this.known.askedMs >= KEPT_MS) {
      this.known = { key, askedMs, vocabulary: await (first ?? this.api.vocabulary(text, profile_text)) };
    }
    return this.known.vocabulary;
  }
}
