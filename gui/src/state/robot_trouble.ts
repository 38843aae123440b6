// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { LinkState, Project, RobotSummary } from "../api/types";
import { baseName } from "../ui/files";
import { readable } from "../ui/numbers";

/** Units of a duration, and how many seconds each has. */
const UNITS_S = [
  ["days", 86_400],
  ["h", 3600],
  ["min", 60],
] as const;

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

/** A duration in its largest unit of which there are at least two, as the server says it. */
export function duration(seconds: number): string {
  const [unit, unitS] = UNITS_S.find(([, size]) => seconds >= 2 * size) ?? ["s", 1];
  return `${Math.floor(seconds / unitS)} ${unit}`;
}

/** How many MB an hour go over a link where it was so many bytes in so many seconds; `–` while nobody can say. */
export function hourly(sizeBytes: number, seconds: number): string {
  return sizeBytes === 0 || seconds < 10 ? "–" : readable((sizeBytes / 1e6) * (3600 / seconds));
}

/** How a link does, in a few words. */
export function linkWords(link: LinkState): string {
  if (!link.connected) return "no operator connected";
  const carries = link.capacity_kb_per_s === null ? "not the limit" : `${readable(link.capacity_kb_per_s)} KB/s`;
  const trip = link.round_trip_ms === null ? "" : `, round trip ${Math.round(link.round_trip_ms)} ms`;
  const lost = link.lost_percent === null ? "" : `, datagrams: ${readable(link.lost_percent)} % lost`;
  return `${carries}${trip}, ${link.outages} ${link.outages === 1 ? "outage" : "outages"}${lost}`;
}
