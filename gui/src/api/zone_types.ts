// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
// What the server says of zones and of the floor below them; src/smarttestudo/web/zone_schemas.py has the meaning.
import type { Rectangle } from "../map/shapes";

export interface RuleZones {
  id: string;
  label: string;
  zones: { topic: string; rectangle: Rectangle; is_shared: boolean }[];
  others: string[];
  holds_elsewhere: boolean;
  is_too_mixed: boolean;
}
export interface ZonesAnswer {
  rules: RuleZones[];
  clashes: { first: string; second: string; message: string; hint: string; common: Rectangle[] }[];
  label: string;
}
export interface CoverAnswer {
  rectangles: Rectangle[];
  polygon_m2: number;
  over_m2: number;
}
export type ZoneEdit =
  | { kind: "zone_new"; topic: string; rectangles: readonly Rectangle[]; into: string | null; label: string }
  | { kind: "zone_move"; id: string; topic: string; dx: number; dy: number }
  | { kind: "zone_resize"; id: string; index: number; rectangle: Rectangle };

export interface BackgroundChoice {
  kind: "map" | "image" | "bag";
  name: string;
}
export interface Background {
  kind: "map" | "image";
  name: string;
  hash: string;
  width_px: number;
  height_px: number;
  metres_per_pixel: number | null;
  x: number;
  y: number;
  yaw_rad: number;
}
export interface DrivenPath {
  path: [t: number, x: number, y: number][];
  notices: string[];
}
