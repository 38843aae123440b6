// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Live, LiveBlock, LiveCheck, Truth } from "../api/live_types";
import type { Check, Condition, RuleDocument, RuleStatement } from "../api/types";

/** What a robot says of one check now. */
export interface CheckState {
  state: Truth;
  value: number | null;
}
/** What a robot says of one rule now, and of its checks in the order of the text. */
export interface RuleState {
  state: Truth;
  checks: readonly CheckState[];
}

/**
 * What a robot says of each rule of a document, by statement id; null where it counts other rules or checks.
 *
 * The robot's text may have other comments and line ends, so rules and checks are paired by their order.
 */
export function ruleStates(document: RuleDocument, live: Live): ReadonlyMap<string, RuleState> | null {
  const rules = document.collections.flatMap(({ statements }) => statements).filter((each) => each.kind === "rule");
  const blocks = [...live.blocks].sort(byPlace);
  const checks = [...live.checks].sort(byPlace);
  const wanted = rules.reduce((sum, rule) => sum + checksOf(rule.condition).length, 0);
  if (rules.length !== blocks.length || wanted !== checks.length) return null;
  return new Map(rules.map((rule, index) => [rule.id ?? "", ruleState(rule, blocks[index], checks)]));
}

/** Takes the checks of the rule from the front of `checks`. */
function ruleState(rule: RuleStatement, block: LiveBlock | undefined, checks: LiveCheck[]): RuleState {
  return { state: block?.state ?? null, checks: checks.splice(0, checksOf(rule.condition).length) };
}

/** All checks of a condition in the order of the text. */
export function checksOf(condition: Condition): Check[] {
  if (condition.kind === "check") return [condition];
  if (condition.kind === "not") return checksOf(condition.term);
  return condition.terms.flatMap(checksOf);
}

function byPlace(a: { line: number; column?: number }, b: { line: number; column?: number }): number {
  return a.line - b.line || (a.column ?? 0) - (b.column ?? 0);
}
