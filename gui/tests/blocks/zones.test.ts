// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type { CheckCondition, Condition, Operator, RuleStatement } from "../../src/api/types";
import { checksIn, rectangleOf, zoneName, zonePicture, zonesIn, zoneText } from "../../src/blocks/zones";

const side = (property: string, op: Operator, value: number): CheckCondition => {
  return { kind: "check", topic: "/odom", property, op, value };
};
const zone = (left: number, isClosed = false): CheckCondition[] => [
  side("pose_x", isClosed ? ">=" : ">", left),
  side("pose_x", "<", left + 4),
  side("pose_y", ">", 0),
  side("pose_y", "<", 2),
];
const all = (terms: Condition[]): Condition => ({ kind: "and", terms });
const rule = (name: string | null, condition: Condition): RuleStatement => {
  const then: RuleStatement["then"] = [];
  return { kind: "rule", name, priority: 0, condition, then, else: [] };
};

test("a zone has the name of the first rule that has it, with a number where that has several", () => {
  const zones = zonesIn([
    rule("Corridor", all([side("speed", "<", 1), ...zone(0)])),
    rule("Fast there", all(zone(0, true))),
    rule("Bays", { kind: "or", terms: [all(zone(10)), { kind: "not", term: all(zone(20)) }] }),
    rule(null, all(zone(30))),
    rule("Elsewhere", side("pose_x", ">", 9)),
  ]);
  expect(zones.map(({ name }) => name)).toEqual(["Corridor", "Bays (1)", "Bays (2)", "x 30 … 34 m, y 0 … 2 m"]);
  expect(zoneName(zone(10, true), zones)).toBe("Bays (1)");
  expect(zoneName(zone(11), zones)).toBe("x 11 … 15 m, y 0 … 2 m");
  expect(zoneName(zone(11).slice(1), zones)).toBe("these checks");
});

test("checks are a zone in any order, and come back as they were", () => {
  const checks = zone(1, true).reverse();
  expect(rectangleOf(checks)).toEqual({ min_x_m: 1, max_x_m: 5, min_y_m: 0, max_y_m: 2 });
  expect(checksIn(zoneText(checks))).toEqual(checks);
  expect(rectangleOf([...checks, side("pose_x", ">", 1)])).toBeNull();
});

test("the picture of a zone shows it among the others of the file", () => {
  const svg = decodeURIComponent(
    zonePicture(zone(0), zonesIn([rule("B", all(zone(10)))]))
      .split(",")
      .slice(1)
      .join(","),
  );
  expect(svg.match(/<rect x="/g)).toHaveLength(2);
  expect(svg).toMatch(/viewBox="0 0 16\.\d+ 4\.\d+"/);
});
