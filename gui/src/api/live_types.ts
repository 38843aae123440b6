// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
// What the server says of running robots; src/smarttestudo/web/robot_schemas.py has the meaning of each.

/** The protocol that this page speaks on the web socket. */
export const PROTOCOL_VERSION = 1;

/** Whether a condition holds now. */
export type Truth = "true" | "false" | "unknown";

/** Where the rules come from that a robot follows. */
export type RulesSource = "files" | "pushed" | "waiting" | "fallback";

export interface RobotSummary {
  node: string;
  is_heard: boolean;
  heard_s_ago: number;
  rules_hash: string;
  rules: RulesSource;
  waits_s: number | null;
  topics: number;
}
export interface Robots {
  problem: string | null;
  robots: RobotSummary[];
}

export interface LiveTopic {
  topic: string;
  source_hz: number | null;
  target_hz: number | null;
  actual_hz: number | null;
  error_percent: number | null;
  keeps_rate: boolean;
  out_kb_per_s: number;
  in_kb_per_s: number;
  rule: string | null;
  reason: string;
  silence: string | null;
  problem: string | null;
}
export interface LiveBlock {
  state: Truth;
  label: string;
}
export interface LiveCheck {
  state: Truth;
  value: number | null;
  topic: string;
  property: string;
  op: string;
  limit: number | null;
}
export interface Live {
  node: string;
  rules_hash: string;
  waits_s: number | null;
  cpu_percent: number | null;
  memory_mb: number | null;
  budget_kb_per_s: number | null;
  out_kb_per_s: number;
  status_kb_per_s: number;
  topics: LiveTopic[];
  blocks: LiveBlock[];
  checks: LiveCheck[];
}

export type Push =
  | { kind: "hello"; version: string; protocol: number }
  | ({ kind: "robots" } & Robots)
  | ({ kind: "live" } & Live)
  | { kind: "progress"; run: string; share: number };

export interface PushPreview {
  differences: string[];
  same: boolean;
  hash: string;
  text_to_send: string;
}
export interface Staged {
  state: "staged" | "same";
  hash: string;
  confirm_within_s: number;
  differences: string[];
}
