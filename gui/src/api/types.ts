// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
// What the server says and understands; src/smarttestudo/web/schemas.py has the meaning of each.

import type { ZoneEdit } from "./zone_types";

export type Tier = "Unacceptable" | "Marginal" | "Acceptable" | "Desirable" | "Competitive" | "Excessive";
export type Operator = ">" | "<" | ">=" | "<=" | "=" | "!=";

export type Rate =
  | { kind: "hz"; value: number }
  | { kind: "tier"; value: Tier }
  | { kind: "full"; value: null }
  | { kind: "off"; value: null };

export interface Check {
  kind: "check";
  topic: string;
  property: string;
  op: Operator;
  value: number;
  offset?: number;
  end_offset?: number;
}
export type Condition =
  | Check
  | { kind: "and"; terms: Condition[] }
  | { kind: "or"; terms: Condition[] }
  | { kind: "not"; term: Condition };

/** Where a statement is; what a request says of it is ignored. */
export interface Placed {
  comments?: string[] | null;
  id?: string;
  key?: string;
  offset?: number;
  end_offset?: number;
  line?: number;
}
export interface SetStatement extends Placed {
  kind: "set";
  topic: string;
  rate: Rate;
}
export interface KeepStatement extends Placed {
  kind: "keep";
  topic: string;
  hz: number;
}
export interface RuleStatement extends Placed {
  kind: "rule";
  name: string | null;
  priority: number;
  condition: Condition;
  then: SetStatement[];
  else: SetStatement[];
  label?: string;
}
export interface RawStatement extends Placed {
  kind: "raw";
  text: string;
}
export type Statement = SetStatement | KeepStatement | RuleStatement | RawStatement;

export interface Collection {
  id: string;
  is_written: boolean;
  statements: Statement[];
}
export type Severity = "error" | "warning" | "info";
export interface Finding {
  index: number;
  code: string;
  severity: Severity;
  message: string;
  hint: string;
  line: number;
  column: number;
  offset: number;
  end_offset: number;
  fix: { title: string; offset: number; end_offset: number; replacement: string } | null;
  statement: string | null;
  related: string[];
}
export interface RuleDocument {
  collections: Collection[];
  findings: Finding[];
  parses: boolean;
}

export type Edit =
  | { kind: "replace"; id: string; statement: Statement }
  | { kind: "insert"; collection: string; index: number; statement: Statement }
  | { kind: "delete"; id: string }
  | { kind: "move"; id: string; collection: string; index: number }
  | ZoneEdit;
export interface EditAnswer {
  text: string;
  document: RuleDocument;
  id: string | null;
}

export type FileKind = "rules" | "profile" | "bag" | "map" | "layout";
export interface ProjectFile {
  name: string;
  kind: FileKind;
  size_bytes: number;
}
export interface Project {
  root_name: string;
  opened: string | null;
  files: ProjectFile[];
  version: string;
  ros: boolean;
  has_more: boolean;
}
export interface FileText {
  name: string;
  text: string;
  hash: string;
}

export interface Property {
  name: string;
  unit: string;
  meaning: string;
}
export interface Vocabulary {
  topics: { topic: string; type: string | null; properties: Property[]; source: string }[];
  every_topic: Property[];
  tiers: Tier[];
}

export interface ProfileRow {
  topic: string;
  type: string | null;
  message_kb: number | null;
  source_hz: number | null;
  tiers_hz: number[] | null;
  priority: number | null;
  min_hz: number | null;
  max_hz: number | null;
}
export interface ProfileTable {
  rows: ProfileRow[];
  budget_kb_per_s: number | null;
}

export interface TopicLoad {
  topic: string;
  rate_hz: number | null;
  kb_per_s: number;
}
export interface Situation {
  kind: "defaults" | "rule" | "worst";
  title: string;
  rules: string[];
  state: Record<string, number>;
  loads: TopicLoad[];
  kb_per_s: number;
  feasible: boolean;
}
export interface Repair {
  title: string;
  edits: { offset: number; end_offset: number; replacement: string }[];
  budget_kb_per_s: number | null;
}
export interface Refusal {
  rule: string | null;
  message: string;
  needs_kb_per_s: number;
  repairs: Repair[];
}
export interface OptimizeAnswer {
  feasible: boolean;
  budget_kb_per_s: number;
  situations: Situation[];
  refusals: Refusal[];
  download_text: string | null;
}

export interface Problem {
  message: string;
  place: string;
  remedy: string;
  findings: Finding[];
}
