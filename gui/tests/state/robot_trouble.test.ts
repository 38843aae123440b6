// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type { LinkState, Project, RobotSummary, RulesInForce } from "../../src/api/types";
import { duration, followersOf, hourly, inOrderOf, linkWords, rulesFor } from "../../src/state/robot_trouble";

const LINK: LinkState = {
  connected: true,
  capacity_kb_per_s: 231.5,
  round_trip_ms: 24.4,
  outages: 1,
  datagrams: false,
  lost_percent: null,
  sent_bytes: 0,
  report_bytes: 0,
};
const RULES: RulesInForce = {
  files: ["/etc/testudo/patrol.adirf"],
  sha256: "ab".repeat(32),
  origin: "files",
  waits_s: null,
};
const WELL: RobotSummary = {
  node: "/ada",
  label: "ada",
  is_heard: true,
  heard_s_ago: 0.4,
  health: null,
  rules: RULES,
  topics: 3,
  budget_kb_per_s: 100,
  out_kb_per_s: 60,
  link: LINK,
  recorded: 0,
};
const named = (label: string, changes: Partial<RobotSummary> = {}): RobotSummary => ({
  ...WELL,
  node: `/${label}`,
  label,
  ...changes,
});
const PROJECT = { root_name: "p", version: "1", ros: true, opened: null } as unknown as Project;
const withFiles = (names: string[], opened: string | null = null): Project => ({
  ...PROJECT,
  opened,
  files: names.map((name) => ({ name, kind: name.endsWith(".toml") ? "profile" : "rules" })) as Project["files"],
});

test.each([
  [7.9, "7 s"],
  [119, "119 s"],
  [582, "9 min"],
  [7200, "2 h"],
  [400_000, "4 days"],
])("%d s are said as the server says them", (seconds, words) => expect(duration(seconds)).toBe(words));

test("rows that nobody holds are in the server's order", () => {
  const robots = [named("new"), named("ada"), named("bob")];
  expect(inOrderOf([], robots)).toEqual(robots);
});

test("rows that are held keep their order, and a robot that comes is the last", () => {
  const robots = [named("new"), named("ada"), named("bob")];
  expect(inOrderOf(["/bob", "/ada", "/gone"], robots).map(({ label }) => label)).toEqual(["bob", "ada", "new"]);
});

test.each<[Project, string | null]>([
  [withFiles(["a.adirf", "night/patrol.adirf"], "a.adirf"), "night/patrol.adirf"],
  [withFiles(["a.adirf", "b.adirf"], "b.adirf"), "b.adirf"],
  [withFiles(["profile.toml", "b.adirf"]), "b.adirf"],
  [withFiles(["profile.toml"]), null],
])("a robot opens beside the rules that it follows, else those of the project", (project, name) => {
  expect(rulesFor(WELL, project)).toBe(name);
});

test.each<[Partial<LinkState>, string]>([
  [{}, "232 KB/s, round trip 24 ms, 1 outage"],
  [{ capacity_kb_per_s: null, round_trip_ms: null, outages: 0 }, "not the limit, 0 outages"],
  [{ datagrams: true, lost_percent: 7.9 }, "232 KB/s, round trip 24 ms, 1 outage, datagrams: 7.9 % lost"],
  [{ connected: false }, "no operator connected"],
])("a link with %j is said in words", (changes, words) => {
  expect(linkWords({ ...LINK, ...changes })).toBe(words);
});

test("a rule file has those followers that run from a file of its name, and not from pushed rules", () => {
  const robots = [
    named("ada"),
    named("bob", { rules: { ...RULES, origin: "pushed" } }),
    named("eve", { rules: { ...RULES, files: ["/x/dock.adirf"] } }),
  ];
  expect(followersOf("night/patrol.adirf", robots).map(({ label }) => label)).toEqual(["ada"]);
});

test("what a link takes an hour is known after ten seconds, of robots that count it", () => {
  expect(hourly(1_000_000, 3600)).toBe("1");
  expect(hourly(4_000_000, 600)).toBe("24");
  expect(hourly(4_000_000, 9)).toBe("–");
  expect(hourly(0, 600)).toBe("–");
});
