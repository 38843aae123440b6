// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { CheckCondition, Condition, Edit, Statement } from "../api/types";

/** A check where a rule says it. */
export interface RobotCheck {
  rule: string;
  /** The key of the rule. */
  key: string;
  check: CheckCondition;
  /** The check with the `For` and `Within` around it alone. */
  condition: Condition;
  /** `/odom pose_y > 5.4 For 2 s`. */
  words: string;
}

/** The checks of rules, in their order. */
export function checksIn(statements: readonly Statement[]): RobotCheck[] {
  return statements.flatMap((one) =>
    one.kind === "rule"
      ? found(one.condition).map((each) => ({ ...each, rule: one.name ?? one.label ?? "", key: one.key ?? "" }))
      : [],
  );
}

function found(condition: Condition): Omit<RobotCheck, "rule" | "key">[] {
  switch (condition.kind) {
    case "check": {
      const { topic, property, op, value, until } = condition;
      const words = `${topic} ${property} ${op} ${value}${until ? ` Until ${until.op} ${until.value}` : ""}`;
      return [{ check: condition, condition, words }];
    }
    case "not":
      return found(condition.term);
    case "timed": {
      const { term, word, duration } = condition;
      const isOne = checkIn(term) !== null;
      return found(term).map((one) =>
        isOne
          ? {
              check: one.check,
              condition: { ...condition, term: one.condition },
              words: `${one.words} ${word} ${duration.value} ${duration.unit}`,
            }
          : one,
      );
    }
    default:
      return condition.terms.flatMap(found);
  }
}

/** The only check below times; null where there is more. */
export function checkIn(condition: Condition): CheckCondition | null {
  if (condition.kind === "timed") return checkIn(condition.term);
  return condition.kind === "check" ? condition : null;
}

/** A condition in which `check` has another threshold. */
export function withValue(condition: Condition, check: CheckCondition, value: number): Condition {
  switch (condition.kind) {
    case "check":
      return condition.offset === check.offset ? { ...condition, value } : condition;
    case "not":
    case "timed":
      return { ...condition, term: withValue(condition.term, check, value) };
    default:
      return { ...condition, terms: condition.terms.map((term) => withValue(term, check, value)) };
  }
}

/** What writes another threshold of a check into the rules. */
export function thresholdEdits(statements: readonly Statement[], one: RobotCheck, value: number): Edit[] {
  const holder = statements.find(({ key }) => key === one.key);
  if (holder?.kind !== "rule") return [];
  const statement = { ...holder, condition: withValue(holder.condition, one.check, value) };
  return [{ kind: "replace", id: holder.id ?? "", statement }];
}
