// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect, signal } from "@preact/signals";
import type { Rules } from "../api/client";
import type { FoundFile } from "../api/types";
import { BagWork } from "./bag_work";
import type { Trial } from "./trial";

/** The tries of one rule file: they go on, and stay, while other pages are looked at. */
export class FileTries {
  readonly work = new BagWork<Trial>();
  /** The last result, also while the next try runs. */
  readonly last = signal<Trial | null>(null);
  /** The recording that somebody chose; null before. */
  readonly bag = signal<string | null>(null);

  constructor() {
    effect(() => {
      const { value } = this.work.state;
      if (value.kind === "done") this.last.value = value.answer;
    });
  }
}

/** The tries of all rule files since the page was loaded. */
export class Tries {
  private readonly files = new Map<string, FileTries>();

  of(name: string): FileTries {
    const tries = this.files.get(name) ?? new FileTries();
    this.files.set(name, tries);
    return tries;
  }
}

/** What a try was about; `recording` is the bag as it was then. */
interface Subject {
  tried: Rules;
  bag: string;
  recording: FoundFile | undefined;
}

/** What of a try is another one by now: `rules`, `profile`, `recording`. `rules` are those of now. */
export function changedSince({ tried, bag, recording }: Subject, rules: Rules, files: readonly FoundFile[]): string[] {
  const now = fileOf(bag, files);
  const isSame = now?.size_bytes === recording?.size_bytes && now?.changed_at_s === recording?.changed_at_s;
  return [
    ...(tried.text === rules.text ? [] : ["rules"]),
    ...(tried.profile_text === rules.profile_text ? [] : ["profile"]),
    ...(now !== undefined && isSame ? [] : ["recording"]),
  ];
}

export function fileOf(bag: string, files: readonly FoundFile[]): FoundFile | undefined {
  return files.find((file) => file.kind === "bag" && file.name === bag);
}

/**
 * The recording that a try of `rules` starts with: the one that is drawn on their map, that their profile was measured
 * in, or that has their name; else the first of `bags`.
 */
export function recordingFor(bags: readonly string[], rules: Rules, drawn: string | null): string {
  const measured = /^# Measured by testudo profile in (.+?): [\d.]+ s,/.exec(rules.profile_text ?? "")?.[1];
  const stem = (name: string) => name.replace(/\.[^./]+$/, "").replace(/^.*\//, "");
  const namesake = bags.find((bag) => stem(bag) === stem(rules.name));
  return [drawn, measured, namesake].find((name) => name != null && bags.includes(name)) ?? bags[0] ?? "";
}

/** The names of the recordings among files, the largest first. */
export function bagsIn(files: readonly FoundFile[]): string[] {
  const bags = files.filter(({ kind }) => kind === "bag").sort((a, b) => b.size_bytes - a.size_bytes);
  return bags.map(({ name }) => name);
}

/** The recording that rules are compared with: the one that somebody chose, else that of `recordingFor`. */
export function recordingOf(bags: readonly string[], tries: FileTries, rules: Rules, drawn: string | null): string {
  const chosen = tries.bag.value;
  return chosen !== null && bags.includes(chosen) ? chosen : recordingFor(bags, rules, drawn);
}
