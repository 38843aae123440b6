// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { MissingMessages, MissingReason } from "../api/types";
import { counted, readable } from "../ui/numbers";

/** Why an incident is not whole, in a list. */
const BRIEFLY: Record<MissingReason, string> = {
  memory: "memory was short",
  late: "began late",
  unpublished: "topic not published",
  ended: "ended early",
  lost: "messages lost",
  disk: "disk too slow",
  killed: "run was killed",
};

const BECAUSE: Record<MissingReason, string> = {
  memory: "the memory for what came before was full",
  late: "nothing was received from the topic yet",
  unpublished: "nobody publishes the topic",
  ended: "the run, or the recording, ended",
  lost: "machine or network were too slow, and the robot lost them",
  disk: "they came faster than the disk could take them, or while it was full",
  killed: "the run was killed",
};

/** `memory was short, ended early`; empty where nothing is missing. */
export function briefly(reasons: readonly MissingReason[]): string {
  return reasons.map((reason) => BRIEFLY[reason]).join(", ");
}

/**
 * `12 messages of /scan, from 5.0 s before to 3.2 s before: the memory for what came before was full`, one for each
 * reason and time; topics of which nobody counted the messages share one.
 */
export function missingWords(missing: readonly MissingMessages[]): string[] {
  const alike = new Map<string, MissingMessages[]>();
  for (const one of missing) {
    const { reason, messages, from_s, to_s } = one;
    const key = messages === null ? `${reason} ${from_s} ${to_s}` : `${alike.size}`;
    alike.set(key, [...(alike.get(key) ?? []), one]);
  }
  return [...alike.values()].map(wordsOf);
}

function wordsOf(alike: readonly MissingMessages[]): string {
  const [one] = alike;
  if (one === undefined) return "";
  const topics = alike.map(({ topic }) => topic).join(", ");
  const what = one.messages === null ? "whatever came on" : `${counted(one.messages, "message")} of`;
  return `${what} ${topics}, from ${sinceMoment(one.from_s)} to ${sinceMoment(one.to_s)}: ${BECAUSE[one.reason]}`;
}

/** A time from the moment of an incident: `3.2 s before`, `the moment`, `0.5 s after`. */
export function sinceMoment(seconds: number): string {
  const size = Math.abs(seconds).toFixed(1);
  if (size === "0.0") return "the moment";
  return `${size} s ${seconds < 0 ? "before" : "after"}`;
}

/** How long a window is: `5 s before to 2 s after`. */
export function windowWords({ before_s, after_s }: { before_s: number; after_s: number }): string {
  return `${readable(before_s)} s before to ${readable(after_s)} s after`;
}
