// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Rules } from "../api/client";

const CHECK_AFTER_MS = 150;
const CHECK_WITHIN_MS = 1000;

/** Asks what rules say now, once at a time: rules of the past are not asked about. */
export class CheckQueue {
  /** How long the server took to answer. */
  answerMs = 0;
  private timer: number | undefined;
  /** What is asked about last, until that is answered. */
  private asked: Rules | null = null;
  private asking: Promise<void> = Promise.resolve();

  constructor(
    private readonly now: () => Rules,
    private readonly ask: (rules: Rules) => Promise<void>,
  ) {}

  /** Asks a moment after the last key. */
  soon(): void {
    window.clearTimeout(this.timer);
    // A long file is not read again between two words.
    const afterMs = Math.min(Math.max(CHECK_AFTER_MS, this.answerMs), CHECK_WITHIN_MS);
    this.timer = window.setTimeout(() => void this.check(), afterMs);
  }

  async check(): Promise<void> {
    window.clearTimeout(this.timer);
    const rules = this.now();
    if (this.asked?.text === rules.text && this.asked.profile_text === rules.profile_text) return this.asking;
    this.asked = rules;
    // Whoever asked before hears what went wrong there.
    const before = this.asking.catch(() => undefined);
    this.asking = before.then(() => (this.asked === rules ? this.answer(rules) : undefined));
    await this.asking;
  }

  private async answer(rules: Rules): Promise<void> {
    try {
      await this.ask(rules);
    } finally {
      if (this.asked === rules) this.asked = null;
    }
  }
}
