// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
// What a try on a bag says; src/smarttestudo/web/try_schemas.py has the meaning of each.

export type Truth = "true" | "false" | "unknown";

export interface Decision {
  t: number;
  topic: string;
  from_hz?: number | null;
  to_hz: number | null;
  reason: string;
  rule?: string | null;
  line?: number | null;
  start?: boolean;
}
export interface TryTopic {
  topic: string;
  before_kb: number;
  after_kb: number;
  before_messages: number;
  after_messages: number;
  target_hz: number | null;
  before_hz_bins: number[];
  after_hz_bins: number[];
}
export interface TryBlock {
  rule: string;
  line: number;
  turns: [t: number, truth: Truth][];
}
export interface Age {
  mean_s: number;
  p95_s: number;
  max_s: number;
  unseen_s: number;
}
export interface TopicLoss {
  topic: string;
  sent: { messages: number; bytes: number; age: Age | null };
  received: { messages: number; bytes: number; age: Age | null };
  age_s_bins: (number | null)[];
}
export interface FieldLoss {
  topic: string;
  field: string;
  unit: string;
  range: number;
  hold: { rmse: number; max: number; relative_rmse: number | null; relative_max: number | null } | null;
  error_bins: (number | null)[];
}
export interface Crossing {
  check: string;
  crossings: number;
  in_time: number;
  late: number;
  missed: number;
  late_mean_s: number | null;
  late_max_s: number | null;
}
export interface ImageLoss {
  topic: string;
  sent: { frames: number; longest_blind_s: number };
  received: { frames: number; longest_blind_s: number };
}
export interface TryLoss {
  topics: TopicLoss[];
  fields: FieldLoss[];
  crossings: Crossing[];
  images: ImageLoss[];
}
export interface TryAnswer {
  duration_s: number;
  bin_s: number;
  first_bin_s: number;
  before_kb: number;
  after_kb: number;
  percent: number;
  decisions: Decision[];
  decision_count: number;
  topics: TryTopic[];
  path: [t: number, x: number, y: number][];
  blocks: TryBlock[];
  loss: TryLoss;
  notices: string[];
}
