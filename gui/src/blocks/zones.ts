// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { CheckCondition, Compared, Condition, Operator, Statement, ZoneRectangle } from "../api/types";
import { extentOf, finiteCorners, sidesWords, widened } from "../map/shapes";

/** The block of a zone, which stands for its four checks. */
export const INSIDE = "adirf_inside";
export const ZONE_CHECKS = 4;

/** A zone that a rule of the file has, by the name of that rule. */
export interface Zone {
  name: string;
  checks: readonly CheckCondition[];
  place: string;
}

/** What a new block says. */
export const NEW_ZONE: readonly CheckCondition[] = [
  { kind: "check", topic: "/odom", property: "pose_x", op: ">", value: 0 },
  { kind: "check", topic: "/odom", property: "pose_x", op: "<", value: 1 },
  { kind: "check", topic: "/odom", property: "pose_y", op: ">", value: 0 },
  { kind: "check", topic: "/odom", property: "pose_y", op: "<", value: 1 },
];

const SIDES: Readonly<Record<string, keyof ZoneRectangle>> = {
  "pose_x >": "min_x_m",
  "pose_x <": "max_x_m",
  "pose_y >": "min_y_m",
  "pose_y <": "max_y_m",
};

/** The rectangle that four checks of one topic bound on every side; null where conditions are something else. */
export function rectangleOf(conditions: readonly Condition[]): ZoneRectangle | null {
  const sides: Partial<Record<keyof ZoneRectangle, number>> = {};
  let topic: string | null = null;
  for (const each of conditions) {
    if (each.kind !== "check" || each.until || typeof each.value !== "number") return null;
    const side = SIDES[`${each.property} ${each.op.charAt(0)}`];
    if (side === undefined || side in sides || each.topic !== (topic ?? each.topic)) return null;
    topic = each.topic;
    sides[side] = each.value;
  }
  const { min_x_m, max_x_m, min_y_m, max_y_m } = sides;
  if (min_x_m === undefined || max_x_m === undefined || min_y_m === undefined || max_y_m === undefined) return null;
  return min_x_m < max_x_m && min_y_m < max_y_m ? { min_x_m, max_x_m, min_y_m, max_y_m } : null;
}

/** The terms of an AND in their order, those that bound a zone as one. */
export function withZones(terms: readonly Condition[]): (Condition | CheckCondition[])[] {
  const all: (Condition | CheckCondition[])[] = [];
  for (let at = 0; at < terms.length; at++) {
    const four = terms.slice(at, at + ZONE_CHECKS);
    const isZone = rectangleOf(four) !== null;
    all.push(isZone ? (four as CheckCondition[]) : (terms[at] as Condition));
    if (isZone) at += ZONE_CHECKS - 1;
  }
  return all;
}

function zonesOf(condition: Condition): CheckCondition[][] {
  if (condition.kind === "check") return [];
  if (condition.kind === "not" || condition.kind === "timed") return zonesOf(condition.term);
  if (condition.kind === "or") return condition.terms.flatMap(zonesOf);
  return withZones(condition.terms).flatMap((each) => (Array.isArray(each) ? [each] : zonesOf(each)));
}

/** The zones of a file; where rules share one, it has the name of the first. */
export function zonesIn(statements: readonly Statement[]): Zone[] {
  const zones = new Map<string, Zone>();
  for (const rule of statements) {
    if (rule.kind !== "rule") continue;
    const own = zonesOf(rule.condition);
    own.forEach((checks, at) => {
      const place = placeOf(checks);
      const name = rule.name && own.length > 1 ? `${rule.name} (${at + 1})` : rule.name || sidesOf(checks);
      if (!zones.has(place)) zones.set(place, { name, checks, place });
    });
  }
  return [...zones.values()];
}

/** Where a zone is, to find out whether two are the same. */
export function placeOf(checks: readonly CheckCondition[]): string {
  return JSON.stringify([checks[0]?.topic, rectangleOf(checks)]);
}

/** What checks are called among the zones of a file. */
export function zoneName(checks: readonly CheckCondition[], zones: readonly Zone[]): string {
  const place = placeOf(checks);
  return zones.find((each) => each.place === place)?.name ?? sidesOf(checks);
}

/** Where a zone is in words. */
export function sidesOf(checks: readonly CheckCondition[]): string {
  const rectangle = rectangleOf(checks);
  return rectangle === null ? "these checks" : sidesWords(rectangle);
}

/** Checks as a field holds them, and back. */
export function zoneText(checks: readonly CheckCondition[]): string {
  return JSON.stringify(checks.map(({ topic, property, op, value }) => [topic, property, op, value]));
}

export function checksIn(text: string): CheckCondition[] {
  const all = JSON.parse(text) as [string, string, Operator, Compared][];
  return all.map(([topic, property, op, value]) => ({ kind: "check", topic, property, op, value }));
}

/** More outlines in so small a picture are no more to be told apart. */
const MOST_OTHERS = 40;

/** A picture of a zone among the others of the file, for the white on a block. */
export function zonePicture(checks: readonly CheckCondition[], zones: readonly Zone[]): string {
  const own = rectangleOf(checks);
  const others = zones.flatMap((each) => rectangleOf(each.checks) ?? []);
  const all = own === null ? others : [...others, own];
  const [left, low, right, high] = widened(extentOf(finiteCorners(all)) ?? [0, 0, 1, 1], 0.08);
  const drawn = (look: string) => (of: ZoneRectangle) => {
    const [x, y] = [Number(of.min_x_m) - left, high - Number(of.max_y_m)];
    const [width, height] = [Number(of.max_x_m) - Number(of.min_x_m), Number(of.max_y_m) - Number(of.min_y_m)];
    return `<rect x="${x}" y="${y}" width="${width}" height="${height}" ${look}/>`;
  };
  const line = 'vector-effect="non-scaling-stroke" stroke="#fff"';
  const shapes = [
    `<rect width="100%" height="100%" fill="#fff" fill-opacity=".16"/>`,
    ...others.slice(0, MOST_OTHERS).map(drawn(`${line} stroke-opacity=".6" fill="none"`)),
    ...(own === null ? [] : [drawn(`${line} fill="#fff" fill-opacity=".85"`)(own)]),
  ];
  const svg = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${right - left} ${high - low}">${shapes.join("")}</svg>`;
  return `data:image/svg+xml,${encodeURIComponent(svg)}`;
}
