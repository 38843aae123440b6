// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type { HealthWords, LinkState, Project, RobotSummary, RulesInForce } from "../../src/api/types";
import { byTrouble, followersOf, inOrderOf, linkWords, rulesFor, troubleOf } from "../../src/state/robot_trouble";

const LINK: LinkState = {
  connected: true,
  capacity_kb_per_s: 231.5,
  round_trip_ms: 24.4,
  outages: 1,
  datagrams: false,
  lost_percent: null,
};
const RULES: RulesInForce = {
  files: ["/etc/testudo/patrol.adirf"],
  sha256: "ab".repeat(32),
  origin: "files",
  waits_s: null,
};
const ERROR: HealthWords = { level: "error", summary: "no valid rules", message: "no valid rules: all is relayed" };
const WARNING: HealthWords = {
  level: "warn",
  summary: "no operator is connected over the link",
  message: "no operator is connected over the link",
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
  lost: 0,
  oldest: { topic: "/scan", age_ms: 80 },
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

test.each<[Partial<RobotSummary>, string]>([
  [{ is_heard: false, heard_s_ago: 12.2 }, "silent for 15 s"],
  [{ is_heard: false, heard_s_ago: 200 }, "silent for 3 min"],
  [{ health: ERROR }, "no valid rules"],
  [{ health: WARNING, lost: 1 }, "no operator is connected over the link"],
  [{ lost: 1 }, "1 message lost"],
  [{ lost: 1200 }, "1 200 messages lost"],
  [{ out_kb_per_s: 101 }, "sends more than its budget"],
  [{ oldest: { topic: "/scan", age_ms: 1500 } }, "/scan arrives late"],
])("a robot with %j is in trouble", (changes, words) => {
  expect(troubleOf(named("ada", changes), 3)?.words).toBe(words);
});

test.each<Partial<RobotSummary>>([
  {},
  { link: null, oldest: null, budget_kb_per_s: null },
  { out_kb_per_s: 100 },
  { rules: { ...RULES, origin: "waiting", waits_s: 5 } },
])("a robot with %j is well", (changes) => {
  expect(troubleOf(named("ada", changes))).toBeNull();
});

test("the silent come first, the longest before all, then other troubles, then the oldest, then by name", () => {
  const robots = [
    named("zoe", { link: null, oldest: null }),
    named("bob", { link: null, oldest: null }),
    named("late", { oldest: { topic: "/scan", age_ms: 1500 } }),
    named("old", { oldest: { topic: "/scan", age_ms: 300 } }),
    named("new"),
    named("gone", { is_heard: false, heard_s_ago: 300 }),
    named("away", { is_heard: false, heard_s_ago: 9 }),
    named("alone", { health: WARNING }),
    named("lawless", { health: ERROR }),
  ];
  const order = ["gone", "away", "lawless", "alone", "late", "old", "new", "bob", "zoe"];
  expect(byTrouble(robots).map(({ label }) => label)).toEqual(order);
  expect(byTrouble([...robots].reverse()).map(({ label }) => label)).toEqual(order);
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
