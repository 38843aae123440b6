// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Signal, signal } from "@preact/signals";
import type { Api } from "../api/client";
import type { FoundFile, RecordedField } from "../api/types";

/** A larger recording is read when somebody asks for it. */
export const READ_AT_ONCE_BYTES = 300e6;
const NONE: readonly RecordedField[] = [];

/** The topics in the recording of rules, and their fields with their texts; a topic is read when somebody asks for it first. */
export class RecordingWords {
  private readonly known = new Map<string, Signal<readonly RecordedField[]>>();
  private readonly found = new Map<string, Signal<readonly string[]>>();

  constructor(
    private readonly api: Api,
    private readonly recording: () => FoundFile | undefined,
  ) {}

  /** The topics as far as they are known by now; whoever follows signals is told of them. */
  topics(): readonly string[] {
    const bag = this.recording()?.name;
    if (bag === undefined) return [];
    const known = this.found.get(bag) ?? signal<readonly string[]>([]);
    if (!this.found.has(bag)) {
      this.found.set(bag, known);
      void this.find(bag, known);
    }
    return known.value;
  }

  private async find(bag: string, known: Signal<readonly string[]>) {
    try {
      known.value = (await this.api.ask("POST /api/recording", { bag })).topics;
    } catch {
      this.found.delete(bag);
    }
  }

  /** What is known by now of a topic; whoever follows signals is told of more. */
  of(topic: string): readonly RecordedField[] {
    const bag = this.recording();
    if (bag === undefined || bag.size_bytes > READ_AT_ONCE_BYTES || !/^\/[^*]+$/.test(topic)) return NONE;
    const key = `${bag.name} ${bag.size_bytes} ${topic}`;
    const known = this.known.get(key) ?? signal(NONE);
    if (!this.known.has(key)) {
      this.known.set(key, known);
      void this.read(key, { bag: bag.name, topic }, known);
    }
    return known.value;
  }

  private async read(key: string, asked: { bag: string; topic: string }, known: Signal<readonly RecordedField[]>) {
    try {
      known.value = (await this.api.ask("POST /api/recording/words", asked)).fields;
    } catch {
      // Where a recording cannot be read, its try says so; the server may be there the next time.
      this.known.delete(key);
    }
  }
}
