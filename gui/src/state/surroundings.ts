// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { computed, type ReadonlySignal, signal } from "@preact/signals";
import { type Api, type Rules, refusalOf } from "../api/client";
import type { PlacedFinding } from "../api/types";
import { CheckQueue } from "./check_queue";

/** The code of a finding on a topic that nobody knows. */
const UNKNOWN = "absent-from-bag";

/** What is found beside the text: on the budget, and on topics that neither robot nor recording nor profile has. */
export class Surroundings {
  private readonly answer = signal<{ text: string; findings: readonly PlacedFinding[] }>({ text: "", findings: [] });
  readonly isKnown = computed(() => this.answer.value.text === this.text.value);
  /** Of the text of now; none before they are known. */
  readonly findings = computed(() => (this.isKnown.value ? this.answer.value.findings : []));
  /** Gives the topics of the recording of the rules. */
  recordedTopics: () => Promise<readonly string[]> = async () => [];
  private readonly asks: CheckQueue;

  constructor(
    private readonly api: Api,
    private readonly text: ReadonlySignal<string>,
    private readonly rules: () => Rules,
  ) {
    this.asks = new CheckQueue(rules, (asked) => this.ask(asked));
  }

  /** Looks once the rules of now stand still for a moment. */
  soon(): void {
    this.asks.soon();
  }

  private async ask(rules: Rules): Promise<void> {
    const asked = (recorded_topics: string[]) => this.api.ask("POST /api/surroundings", { ...rules, recorded_topics });
    // What does not answer now is asked for again with the next change; the top of the page tells of it.
    await refusalOf(async () => {
      let { findings } = await asked([]);
      // A recording is read only where its topics matter.
      const recorded = findings.some(({ code }) => code === UNKNOWN) ? await this.recordedTopics() : [];
      if (recorded.length > 0) findings = (await asked([...recorded])).findings;
      const now = this.rules();
      if (now.text === rules.text && now.profile_text === rules.profile_text) {
        this.answer.value = { text: rules.text, findings };
      }
    });
  }
}
