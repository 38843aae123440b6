// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { CheckCondition, Condition, Edit, Statement, RobotCheck as ToldCheck } from "../api/types";
import type { RuleEditor } from "./rule_editor";

/** A check where a rule says it. */
export interface RobotCheck {
  rule: string;
  /** The key of the rule. */
  key: string;
  /** Which of the rule's checks it is. */
  at: number;
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
      ? found(one.condition).map((each, at) => ({ ...each, at, rule: one.name ?? one.label ?? "", key: one.key ?? "" }))
      : [],
  );
}

function found(condition: Condition): Omit<RobotCheck, "rule" | "key" | "at">[] {
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
  // A rule of the same key has the same checks, which may stand elsewhere by now.
  const check = found(holder.condition)[one.at]?.check;
  if (check === undefined) return [];
  const statement = { ...holder, condition: withValue(holder.condition, check, value) };
  return [{ kind: "replace", id: holder.id ?? "", statement }];
}

/** Writes another threshold of the check that `find` gives into the rules of an editor; `missing` is why there is none. */
export function writeThreshold(
  editor: RuleEditor,
  value: number,
  find: (statements: readonly Statement[]) => RobotCheck | undefined,
  missing: string,
): Promise<void> {
  return editor.edit(() => {
    const statements = editor.statements.peek();
    const one = find(statements);
    const edits = one ? thresholdEdits(statements, one, value) : [];
    if (edits.length === 0) editor.message.value = `${missing}, so ${value} was not written`;
    return edits;
  });
}

/** The check of rules that a robot means by its words, in the rule of its name, or else the only such one. */
export function checkOfRobot(
  statements: readonly Statement[],
  { rule, topic, property, op, limit }: ToldCheck,
): RobotCheck | undefined {
  const alike = checksIn(statements).filter(
    ({ check }) => check.topic === topic && check.property === property && check.op === op && check.value === limit,
  );
  return alike.find((each) => each.rule === rule) ?? (alike.length === 1 ? alike[0] : undefined);
}
