// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Extent, Point } from "./shapes";

/** What pressing on the map does. */
export type Tool = "choose" | "rectangle" | "polygon";

/** What somebody drew. */
export type Drawn = { kind: "rectangle"; sides: Extent } | { kind: "polygon"; corners: Point[] };

/** What the map tells; every part may be left out. */
export interface MapOwner {
  /** The pointer moved over this place; null when it left. */
  pointed?: (place: Point | null) => void;
  /** Somebody pressed a rectangle of a zone, or beside all of them. */
  chosen?: (id: string | null, rectangle: number) => void;
  /** A zone was dragged by so much. */
  moved?: (id: string, by: Point) => void;
  /** The rectangle with the handles was given other sides. */
  resized?: (id: string, rectangle: Extent) => void;
  drawn?: (shape: Drawn) => void;
  /** The scale bar is `px` long now and stands for `metres`. */
  scaled?: (bar: { metres: number; px: number }) => void;
  /** The picture could not be loaded. */
  failed?: () => void;
}
