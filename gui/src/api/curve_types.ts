// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
// What a topic loses at each rate; src/smarttestudo/web/curve_schemas.py has the meaning of each.

export interface CurvePoint {
  rate_hz: number;
  kb_per_s: number;
  error_percent: number | null;
  worst_field: string | null;
  age_mean_s: number | null;
}
export interface Curve {
  source_hz: number | null;
  points: CurvePoint[];
  tiers_hz: number[] | null;
  notices: string[];
}
