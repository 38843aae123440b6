// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ZoneRectangle } from "../api/types";

/** A place in the frame of the map, in metres. */
export type Point = readonly [x: number, y: number];

/** Left, lower, right and upper end in metres. */
export type Extent = readonly [min_x_m: number, min_y_m: number, max_x_m: number, max_y_m: number];

/**
 * A picture of the floor. Its lower left corner lies at (`x`, `y`), and it is turned about it by `yaw_rad`.
 *
 * `is_stencil` says that only its opacity counts: it is drawn in the colour of the text, light or dark.
 */
export interface MapPicture {
  url: string;
  width_m: number;
  height_m: number;
  x: number;
  y: number;
  yaw_rad: number;
  is_stencil: boolean;
}

/** Zones of one rule; `tone` colours them, `selected` puts handles on the rectangle number `handle`. */
export interface MapZone {
  id: string;
  label: string;
  rectangles: readonly ZoneRectangle[];
  tone: "zone" | "selected" | "clash" | "draft";
  /** Which rectangle has handles to resize it. */
  handle?: number | undefined;
  /** Whether it can be dragged. */
  movable?: boolean;
}

const FAR_M = 1e5;

/** `rectangle` with its open sides at the borders of `around`. */
export function closed(rectangle: ZoneRectangle, around: Extent | null): Extent {
  const [left, low, right, high] = around ?? [-FAR_M, -FAR_M, FAR_M, FAR_M];
  return [
    rectangle.min_x_m ?? Math.min(left, rectangle.max_x_m ?? left),
    rectangle.min_y_m ?? Math.min(low, rectangle.max_y_m ?? low),
    rectangle.max_x_m ?? Math.max(right, rectangle.min_x_m ?? right),
    rectangle.max_y_m ?? Math.max(high, rectangle.min_y_m ?? high),
  ];
}

/** `sides` where `known` is bounded; what was open stays so. */
export function bounded(known: ZoneRectangle, [left, low, right, high]: Extent): ZoneRectangle {
  return {
    min_x_m: known.min_x_m === null ? null : left,
    max_x_m: known.max_x_m === null ? null : right,
    min_y_m: known.min_y_m === null ? null : low,
    max_y_m: known.max_y_m === null ? null : high,
  };
}

/** The sides of a rectangle in words. */
export function sidesWords({ min_x_m, max_x_m, min_y_m, max_y_m }: ZoneRectangle): string {
  const axis = (name: string, from: number | null, to: number | null) => {
    if (from === null && to === null) return `any ${name}`;
    if (from === null) return `${name} below ${to} m`;
    return to === null ? `${name} above ${from} m` : `${name} ${from} … ${to} m`;
  };
  return `${axis("x", min_x_m, max_x_m)}, ${axis("y", min_y_m, max_y_m)}`;
}

/** The four corners of a picture, from its lower left one against the clock. */
export function cornersOf(picture: MapPicture): Point[] {
  const [cos, sin] = [Math.cos(picture.yaw_rad), Math.sin(picture.yaw_rad)];
  const sides: Point[] = [
    [0, 0],
    [picture.width_m, 0],
    [picture.width_m, picture.height_m],
    [0, picture.height_m],
  ];
  return sides.map(([along, up]) => [picture.x + along * cos - up * sin, picture.y + along * sin + up * cos]);
}

/** The extent of all `points`; null without any. */
export function extentOf(points: Iterable<Point>): Extent | null {
  let extent: [number, number, number, number] | null = null;
  for (const [x, y] of points) {
    extent ??= [x, y, x, y];
    extent = [Math.min(extent[0], x), Math.min(extent[1], y), Math.max(extent[2], x), Math.max(extent[3], y)];
  }
  return extent;
}

/** The finite corners of rectangles, as points to take an extent of. */
export function* finiteCorners(rectangles: Iterable<ZoneRectangle>): Generator<Point> {
  for (const { min_x_m, max_x_m, min_y_m, max_y_m } of rectangles) {
    const [xs, ys] = [[min_x_m, max_x_m].filter(isNumber), [min_y_m, max_y_m].filter(isNumber)];
    for (const x of xs.length ? xs : [0]) for (const y of ys.length ? ys : [0]) yield [x, y];
  }
}

/** `extent` with a margin of `share` of its longer side, at least one metre. */
export function widened(extent: Extent, share: number): Extent {
  const margin = Math.max(extent[2] - extent[0], extent[3] - extent[1], 1 / share) * share;
  return [extent[0] - margin, extent[1] - margin, extent[2] + margin, extent[3] + margin];
}

/** An extent with so many metres more on each side. */
export function grown([min_x_m, min_y_m, max_x_m, max_y_m]: Extent, metres: number): Extent {
  return [min_x_m - metres, min_y_m - metres, max_x_m + metres, max_y_m + metres];
}

/** To whole centimetres, which is how zones are written. */
export function toCentimetres(value: number): number {
  return Math.round(value * 100) / 100 + 0;
}

function isNumber(value: number | null): value is number {
  return value !== null;
}

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
