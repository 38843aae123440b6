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

  async of({ text, profile_text }: Rules, document: RuleDocument): Promise<Vocabulary> {
    const key = JSON.stringify([profile_text, [...topicsIn(document)].sort()]);
    const askedMs = performance.now();
    if (key !== this.known?.key || askedMs - this.known.askedMs >= KEPT_MS) {
      this.known = { key, askedMs, vocabulary: await this.api.vocabulary(text, profile_text) };
    }
    return this.known.vocabulary;
  }
}
