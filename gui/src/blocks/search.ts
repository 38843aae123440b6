// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { PlacedFinding, Statement } from "../api/types";
import { checksOf, type RuleState } from "./live_states";
import { actionWords } from "./rule_words";

/** What a search is limited to. */
export type Limit = "all" | "off" | "findings" | "holds";

/** A statement that was found, with its number in the order of the text. */
export interface Found {
  readonly index: number;
  readonly statement: Statement;
}

/** What is known of statements beside their words, by statement id. */
export interface Known {
  findings: readonly PlacedFinding[];
  states: ReadonlyMap<string, RuleState>;
}

/** The statements in which every word of `query` stands in a name, comment, topic, property or rate. */
export function found(all: readonly Statement[], query: string, limit: Limit, known: Known): Found[] {
  const words = query.toLowerCase().split(/\s+/).filter(Boolean);
  const isWithin = within(limit, known);
  return all
    .map((statement, index) => ({ statement, index }))
    .filter(({ statement }) => isWithin(statement))
    .filter(({ statement }) => {
      const text = saidIn(statement).join(" ").toLowerCase();
      return words.every((word) => text.includes(word));
    });
}

function within(limit: Limit, { findings, states }: Known): (statement: Statement) => boolean {
  switch (limit) {
    case "all":
      return () => true;
    case "off":
      return (statement) => statement.kind === "rule" && statement.is_disabled === true;
    case "findings": {
      const ids = new Set(findings.map(({ statement }) => statement));
      return ({ id }) => id !== undefined && ids.has(id);
    }
    case "holds":
      return ({ id }) => states.get(id ?? "")?.state === "true";
  }
}

/** What people look for in a statement: no keywords, which are in all of them. */
function saidIn(statement: Statement): string[] {
  const comments = statement.comments ?? [];
  switch (statement.kind) {
    case "rule": {
      const checks = checksOf(statement.condition).flatMap(({ topic, property, op, value }) => [
        topic,
        property,
        `${property} ${op} ${value}`,
      ]);
      const actions = [...statement.then, ...statement.else].map(actionWords);
      return [statement.name ?? statement.label ?? "", ...comments, ...checks, ...actions];
    }
    case "keep":
      return [...comments, statement.topic, `${statement.hz} Hz`];
    case "raw":
      return [...comments, statement.text];
    default:
      return [...comments, actionWords(statement)];
  }
}
