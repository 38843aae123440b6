// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect, signal } from "@preact/signals";
import type { Rules } from "../api/client";
import type { FoundFile, TryHeadline } from "../api/types";
import { BagWork } from "./bag_work";
import type { FolderTrial, Trial } from "./trial";

/** What a try says first of what was sent. */
type Sent = Pick<TryHeadline, "after_kb" | "duration_s" | "percent">;

/** The tries of one rule file: they go on, and stay, while other pages are looked at. */
export class FileTries {
  readonly work = new BagWork<Trial>();
  /** The last result, also while the next try runs. */
  readonly last = signal<Trial | null>(null);
  readonly folderWork = new BagWork<FolderTrial>();
  /** The last tries on a folder, also while they run and where they were ended. */
  readonly folder = signal<FolderTrial | null>(null);
  /** The recording, or the folder with its `/`, that somebody chose; null before. */
  readonly chosen = signal<string | null>(null);

  /** `remember` is told what a try on a recording, or on those of a folder, said. */
  constructor(readonly remember: (bag: string, said: Sent) => void) {
    effect(() => {
      const { value } = this.work.state;
      if (value.kind === "done") this.last.value = value.answer;
    });
  }
}

/** The tries of all rule files since the page was loaded. */
export class Tries {
  private readonly files = new Map<string, FileTries>();

  constructor(private readonly remember: (name: string, bag: string, said: Sent) => void) {}

  of(name: string): FileTries {
    const tries = this.files.get(name) ?? new FileTries((bag, said) => this.remember(name, bag, said));
    this.files.set(name, tries);
    return tries;
  }
}

/** What was tried: the rules and the recordings as they were then. */
export interface Tried {
  readonly tried: Rules;
  readonly recordings: readonly (FoundFile | undefined)[];
}

/** What of a try is another one by now: `rules`, `profile`, `recording`. `rules` and `recordings` are those of now. */
export function changedSince(then: Tried, rules: Rules, recordings: readonly (FoundFile | undefined)[]): string[] {
  const isSame = (now: FoundFile | undefined, index: number) => {
    const before = then.recordings[index];
    return (
      now !== undefined &&
      now.name === before?.name &&
      now.size_bytes === before.size_bytes &&
      now.changed_at_s === before.changed_at_s
    );
  };
  const areSame = recordings.length === then.recordings.length && recordings.every(isSame);
  return [
    ...(then.tried.text === rules.text ? [] : ["rules"]),
    ...(then.tried.profile_text === rules.profile_text ? [] : ["profile"]),
    ...(areSame ? [] : ["recording"]),
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

/** All recordings of the project, where a folder is asked for. */
export const ALL = "/";

/** The recordings below a folder, by name. */
export function recordingsIn(folder: string, files: readonly FoundFile[]): FoundFile[] {
  return files.filter(({ kind, name }) => kind === "bag" && (folder === ALL || name.startsWith(folder)));
}

/**
 * The folders with at least two recordings, and how many they hold: all of them first, then by name. A folder that was
 * `tried` is among them whatever it holds.
 */
export function foldersIn(files: readonly FoundFile[], tried?: string): [string, number][] {
  const all = recordingsIn(ALL, files);
  const counts = new Map<string, number>(tried === undefined || tried === ALL ? [] : [[tried, 0]]);
  for (const { name } of all) {
    for (const { index } of name.matchAll(/\//g)) {
      const folder = name.slice(0, index + 1);
      counts.set(folder, (counts.get(folder) ?? 0) + 1);
    }
  }
  const folders = [...counts].sort(([a], [b]) => (a < b ? -1 : 1));
  return ([[ALL, all.length], ...folders] as [string, number][]).filter(([name, count]) => count > 1 || name === tried);
}

export function folderWords(folder: string): string {
  return folder === ALL ? "the project" : folder;
}

/** The recording that rules are compared with: the one that somebody chose, else that of `recordingFor`. */
export function recordingOf(bags: readonly string[], tries: FileTries, rules: Rules, drawn: string | null): string {
  const chosen = tries.chosen.value;
  return chosen !== null && bags.includes(chosen) ? chosen : recordingFor(bags, rules, drawn);
}
