// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Rules } from "../api/client";

/** After a shorter pause typing goes on. */
const PAUSE_MS = 300;

/** Asks what rules say now, once at a time: rules of the past are not asked about. */
export class CheckQueue {
  private timer: number | undefined;
  /** What is asked about last, until that is answered. */
  private asked: Rules | null = null;
  private asking: Promise<void> = Promise.resolve();

  constructor(
    private readonly now: () => Rules,
    private readonly ask: (rules: Rules) => Promise<void>,
  ) {}

  /** Asks once no key came for a moment. */
  soon(): void {
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => void this.check(), PAUSE_MS);
  }

  async check(): Promise<void> {
    window.clearTimeout(this.timer);
    const rules = this.now();
    if (this.asked?.text === rules.text && this.asked.profile_text === rules.profile_text) return this.asking;
    this.asked = rules;
    // A failure of the question before reaches its own caller.
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
