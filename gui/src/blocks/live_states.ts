// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Compared, Condition, Live, RobotCheck, RuleDocument, TimedCondition, Truth } from "../api/types";
import { checksOf, statementsIn } from "../state/statements";

/** What a robot says of one check now. */
export interface CheckState {
  state: Truth;
  value: number | string | null;
}
/** What a robot says of a `For` now: for how long it has held; of a `Within`: for how long it has not. */
export interface TimeState {
  state: Truth;
  held_s: number | null;
}
/** What a robot says of one rule now, of its checks in the order of the text, and of its times as they end in it. */
export interface RuleState {
  state: Truth;
  checks: readonly CheckState[];
  times: readonly TimeState[];
}

const UNKNOWN: CheckState = { state: "unknown", value: null };

/**
 * What a robot says of each rule of a document, by statement id; rules that it does not tell of are left out.
 *
 * The robot's text may have other comments and another order, so rules are found by what they are called, and
 * checks by their words: equal checks hold at the same time.
 */
export function ruleStates(document: RuleDocument, live: Live): ReadonlyMap<string, RuleState> {
  const all = statementsIn(document);
  const rules = all.filter((each) => each.kind === "rule").filter((each) => !each.is_disabled);
  const labels = numbered(live.labels);
  const blocks = new Map(live.status.blocks.map((block, index) => [labels[index], block]));
  const checks = new Map(readChecks(live).map((check) => [words({ ...check, value: check.limit }), check]));
  const states = new Map<string, RuleState>();
  numbered(rules.map(({ label = "" }) => label)).forEach((label, index) => {
    const [rule, block] = [rules[index], blocks.get(label)];
    if (!rule || block === undefined) return;
    const own = checksOf(rule.condition).map((check) => checks.get(words(check)) ?? UNKNOWN);
    const { state } = block;
    const times = (block.times ?? []).map(([, , state, held_s]) => ({ state, held_s }));
    const isKnown = times.length === timesOf(rule.condition).length;
    states.set(rule.id ?? "", { state, checks: own, times: isKnown ? times : [] });
  });
  return states;
}

/** The checks of a robot's rules whose words are known, with what each reads now. */
export function readChecks({ status, checks }: Live): (RobotCheck & CheckState)[] {
  const read = status.blocks.flatMap((block) => block.checks);
  return read.flatMap(([, , state, value], at) => {
    const written = checks[at];
    return written ? [{ ...written, state, value }] : [];
  });
}

/** Names that tell rules apart: those of one name are numbered, and so are unnamed ones, whose line may move. */
function numbered(labels: readonly string[]): string[] {
  const seen = new Map<string, number>();
  return labels.map((label) => {
    const name = label.replace(/^block at line \d+$/, "");
    const number = (seen.get(name) ?? 0) + 1;
    seen.set(name, number);
    return `${number} ${name}`;
  });
}

function words(check: { topic: string; property: string; op: string; value: Compared }): string {
  return `${check.topic} ${check.property} ${check.op} ${check.value}`;
}

/** All times of a condition, in the order in which they end in the text. */
export function timesOf(condition: Condition): TimedCondition[] {
  if (condition.kind === "check") return [];
  if (condition.kind === "not") return timesOf(condition.term);
  if (condition.kind === "timed") return [...timesOf(condition.term), condition];
  return condition.terms.flatMap(timesOf);
}
