// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { LinkState, Project, RobotSummary } from "../api/types";
import { baseName } from "../ui/files";
import { readable } from "../ui/numbers";

/** A message that is older than this when it arrives is of little use for driving. */
export const OLD_MS = 1000;
const LONGEST_IN_S = 120;
const S_PER_MIN = 60;

/** What is wrong with a robot, in words; `rank` orders troubles, the worst is 0. */
interface Trouble {
  rank: number;
  words: string;
}

/** The worst that is known of a robot, null where all is well; `robotsAgeS` is how old `robot` is. */
export function troubleOf(robot: RobotSummary, robotsAgeS = 0): Trouble | null {
  const found = TROUBLES.findIndex(({ holds }) => holds(robot));
  const trouble = TROUBLES[found];
  return trouble ? { rank: found, words: trouble.words(robot, robotsAgeS) } : null;
}

const TROUBLES: {
  holds: (robot: RobotSummary) => boolean;
  words: (robot: RobotSummary, robotsAgeS: number) => string;
}[] = [
  {
    holds: ({ is_heard }) => !is_heard,
    words: ({ heard_s_ago }, robotsAgeS) => `silent for ${duration(heard_s_ago + robotsAgeS)}`,
  },
  { holds: ({ health }) => health?.level === "error", words: ({ health }) => health?.summary ?? "" },
  { holds: ({ health }) => health !== null, words: ({ health }) => health?.summary ?? "" },
  {
    holds: ({ lost }) => lost > 0,
    words: ({ lost }) => `${readable(lost)} ${lost === 1 ? "message" : "messages"} lost`,
  },
  { holds: isOverBudget, words: () => "sends more than its budget" },
  {
    holds: ({ oldest }) => oldest !== null && oldest.age_ms > OLD_MS,
    words: ({ oldest }) => `${oldest?.topic} arrives late`,
  },
];

/** Whether a robot sends more than it may. */
export function isOverBudget({ budget_kb_per_s, out_kb_per_s }: RobotSummary): boolean {
  return budget_kb_per_s !== null && out_kb_per_s > budget_kb_per_s;
}

/** The robots with the worst trouble first, those that are silent the longest before all; then the oldest, then by name. */
export function byTrouble(robots: readonly RobotSummary[]): RobotSummary[] {
  const rank = (robot: RobotSummary) => troubleOf(robot)?.rank ?? TROUBLES.length;
  const silence = (robot: RobotSummary) => (robot.is_heard ? 0 : robot.heard_s_ago);
  const age = (robot: RobotSummary) => robot.oldest?.age_ms ?? -1;
  return [...robots].sort(
    (one, other) =>
      rank(one) - rank(other) ||
      silence(other) - silence(one) ||
      age(other) - age(one) ||
      one.label.localeCompare(other.label),
  );
}

/** `robots` in the order of `nodes`; those that are not among them come last. */
export function inOrderOf(nodes: readonly string[], robots: readonly RobotSummary[]): RobotSummary[] {
  const place = new Map(nodes.map((node, index) => [node, index]));
  const of = ({ node }: RobotSummary) => place.get(node) ?? nodes.length;
  return [...robots].sort((one, other) => of(one) - of(other));
}

/** The rule file in which to open a robot: the one that it follows by name, else the project's, else any. */
export function rulesFor({ rules }: RobotSummary, { files, opened }: Project): string | null {
  const names = files.filter(({ kind }) => kind === "rules").map(({ name }) => name);
  const followed = new Set(rules.files.map(baseName));
  return names.find((name) => followed.has(baseName(name))) ?? opened ?? names[0] ?? null;
}

/** The robots that follow the rule file of a project, as far as its name tells. */
export function followersOf(name: string, robots: readonly RobotSummary[]): RobotSummary[] {
  return robots.filter(
    ({ rules }) => rules.origin === "files" && rules.files.some((path) => baseName(path) === baseName(name)),
  );
}

/** A duration for reading: seconds up to two minutes, then minutes. */
export function duration(seconds: number): string {
  return seconds < LONGEST_IN_S ? `${Math.floor(seconds)} s` : `${Math.floor(seconds / S_PER_MIN)} min`;
}

/** How a link does, in a few words. */
export function linkWords(link: LinkState): string {
  if (!link.connected) return "no operator connected";
  const carries = link.capacity_kb_per_s === null ? "not the limit" : `${readable(link.capacity_kb_per_s)} KB/s`;
  const trip = link.round_trip_ms === null ? "" : `, round trip ${Math.round(link.round_trip_ms)} ms`;
  const lost = link.lost_percent === null ? "" : `, datagrams: ${readable(link.lost_percent)} % lost`;
  return `${carries}${trip}, ${link.outages} ${link.outages === 1 ? "outage" : "outages"}${lost}`;
}

/** An age for reading. */
export function age(ms: number): string {
  return ms < OLD_MS ? `${Math.round(ms)} ms` : `${readable(ms / 1000)} s`;
}
