// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { CheckCondition, IncidentRecord, Missing, MissingReason, Operator } from "../api/types";
import { unquoted } from "../blocks/compared";
import { counted, readable, valueText } from "../ui/numbers";

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
  lost: "the middleware lost them: machine or network were too slow, or their sender lacked shared memory",
  disk: "they came faster than the disk could take them, or while it was full",
  killed: "the run was killed",
};

/** `memory was short, ended early`; `something` where no reason is known, and empty where nothing is missing. */
export function briefly(reasons: readonly string[]): string {
  const words: Record<string, string | undefined> = BRIEFLY;
  const known = [...new Set(reasons)].flatMap((reason) => words[reason] ?? []);
  // A robot of another version may know further ones.
  return known.length === 0 && reasons.length > 0 ? "something" : known.join(", ");
}

/** The seconds between two stamps, whose last digits are lost here: in whole µs they are exact. */
function secondsTo(ns: number, sinceNs: number): number {
  return Math.round((ns - sinceNs) / 1000) / 1e6;
}

/**
 * `12 messages of /scan, from 5.0 s before to 3.2 s before: the memory for what came before was full`, one for each
 * reason and time; topics of which nobody counted the messages share one.
 */
export function missingWords(missing: readonly Missing[], triggeredNs: number): string[] {
  const alike = new Map<string, Missing[]>();
  for (const one of missing) {
    const { reason, messages, from_ns, to_ns } = one;
    const key = messages === null ? `${reason} ${from_ns} ${to_ns}` : `${alike.size}`;
    alike.set(key, [...(alike.get(key) ?? []), one]);
  }
  return [...alike.values()].map((some) => wordsOf(some, triggeredNs));
}

function wordsOf(alike: readonly Missing[], triggeredNs: number): string {
  const [one] = alike;
  if (one === undefined) return "";
  const topics = alike.map(({ topic }) => topic).join(", ");
  const what = one.messages === null ? "whatever came on" : `${counted(one.messages, "message")} of`;
  const [from, to] = [one.from_ns, one.to_ns].map((ns) => sinceTrigger(ns, triggeredNs));
  return `${what} ${topics}, from ${from} to ${to}: ${BECAUSE[one.reason]}`;
}

/** A time from the moment of an incident: `3.2 s before`, `the moment`, `0.5 s after`. */
export function sinceMoment(seconds: number): string {
  const size = Math.abs(seconds).toFixed(1);
  if (size === "0.0") return "the moment";
  return `${size} s ${seconds < 0 ? "before" : "after"}`;
}

/** A stamp as a time from the moment of an incident. */
export function sinceTrigger(ns: number, triggeredNs: number): string {
  return sinceMoment(secondsTo(ns, triggeredNs));
}

/** What a condition read: `/scan distance was 0.41 m, below 0.9 m`, one for each value. */
export function valueWords(
  values: IncidentRecord["values"],
  units: Readonly<Record<string, string>>,
  checks: readonly CheckCondition[] = [],
): string[] {
  return Object.entries(values).map(([signal, value]) => {
    if (value === null) return `${signal} was unknown or infinite`;
    const withUnit = (one: number | string) => [valueText(one), units[signal]].filter(Boolean).join(" ");
    const compared = checks
      .filter(({ topic, property }) => isSignal(signal, topic, property))
      .map(({ op, value: limit }) => {
        const plain = typeof limit === "string" && limit.startsWith('"') ? unquoted(limit) : limit;
        return `${COMPARES[op](value, plain) ? "" : "not "}${OP_WORDS[op]} ${withUnit(plain)}`;
      });
    return [`${signal} was ${withUnit(value)}`, [...new Set(compared)].join(" and ")].filter(Boolean).join(", ");
  });
}

/** Whether a rule means a signal by a topic, which it may write without the robot's namespace, and a property. */
function isSignal(signal: string, topic: string, property: string): boolean {
  const words = `${topic} ${property}`;
  return topic.startsWith("/") ? signal === words : signal.endsWith(`/${words}`);
}

const OP_WORDS: Record<Operator, string> = {
  "<": "below",
  ">": "above",
  "<=": "at most",
  ">=": "at least",
  "=": "equal to",
  "!=": "other than",
};

type Compare = (value: number | string, limit: number | string) => boolean;

const COMPARES: Record<Operator, Compare> = {
  "<": (value, limit) => value < limit,
  ">": (value, limit) => value > limit,
  "<=": (value, limit) => value <= limit,
  ">=": (value, limit) => value >= limit,
  "=": (value, limit) => value === limit,
  "!=": (value, limit) => value !== limit,
};

/** The moments after the first at which the rule began to hold: `3.2 s after: /scan distance was 0.41 m`. */
export function furtherWords(
  record: IncidentRecord,
  units: Readonly<Record<string, string>>,
  checks: readonly CheckCondition[] = [],
): string[] {
  const { triggered_ns, moments = 1, further_moments = [] } = record;
  const listed = further_moments.map((one) =>
    [sinceTrigger(one.triggered_ns, triggered_ns), valueWords(one.values, units, checks).join(", ")]
      .filter(Boolean)
      .join(": "),
  );
  const more = moments - 1 - listed.length;
  return more > 0 ? [...listed, `and ${counted(more, "time")} more`] : listed;
}

/** The sum of messages or bytes over the topics of an incident. */
export function sumOf(topics: IncidentRecord["topics"], what: "messages" | "bytes"): number {
  return Object.values(topics).reduce((sum, topic) => sum + topic[what], 0);
}

/** The window of an incident. */
interface Stamps {
  from_ns: number;
  triggered_ns: number;
  to_ns: number;
}

/** How long a window is: `5 s before to 2 s after`. */
export function windowWords({ from_ns, triggered_ns, to_ns }: Stamps): string {
  const [beforeS, afterS] = [secondsTo(triggered_ns, from_ns), secondsTo(to_ns, triggered_ns)];
  return `${readable(beforeS)} s before to ${readable(afterS)} s after`;
}
