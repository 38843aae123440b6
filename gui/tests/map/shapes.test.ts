// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { describe, expect, test } from "vitest";
import type { ZoneRectangle } from "../../src/api/types";
import {
  closed,
  cornersOf,
  type Extent,
  extentOf,
  finiteCorners,
  type MapPicture,
  toCentimetres,
  widened,
} from "../../src/map/shapes";

const OPEN: ZoneRectangle = { min_x_m: null, max_x_m: null, min_y_m: null, max_y_m: null };
const AROUND: Extent = [-10, -5, 10, 5];

describe("a zone with open sides", () => {
  test("is drawn up to the border of what is shown", () => {
    expect(closed(OPEN, AROUND)).toEqual(AROUND);
    expect(closed({ ...OPEN, min_x_m: 2, max_y_m: 1 }, AROUND)).toEqual([2, -5, 10, 1]);
  });

  test("beyond that border never turns inside out", () => {
    const [left, , right] = closed({ ...OPEN, min_x_m: 40 }, AROUND);
    expect([left, right]).toEqual([40, 40]);
    const [, low, , high] = closed({ ...OPEN, max_y_m: -40 }, AROUND);
    expect([low, high]).toEqual([-40, -40]);
  });

  test("has a place on a map that shows nothing yet", () => {
    const [left, low, right, high] = closed({ ...OPEN, min_x_m: 3 }, null);
    expect(left).toBe(3);
    expect([low, right, high].every(Number.isFinite)).toBe(true);
  });

  test("is looked for at its bounds, and at 0 where it has none", () => {
    expect([...finiteCorners([{ ...OPEN, min_x_m: 3, max_x_m: 4 }])]).toEqual([
      [3, 0],
      [4, 0],
    ]);
    expect([...finiteCorners([{ min_x_m: 1, max_x_m: 2, min_y_m: 3, max_y_m: 4 }])]).toHaveLength(4);
  });
});

describe("the picture of a floor", () => {
  const picture: MapPicture = { url: "", width_m: 4, height_m: 2, x: 1, y: 1, yaw_rad: 0, is_stencil: true };

  test("lies with its lower left corner at its origin", () => {
    expect(cornersOf(picture)).toEqual([
      [1, 1],
      [5, 1],
      [5, 3],
      [1, 3],
    ]);
  });

  test("is turned about that corner, against the clock", () => {
    const corners = cornersOf({ ...picture, yaw_rad: Math.PI / 2 });
    expect(corners.map((corner) => corner.map(toCentimetres))).toEqual([
      [1, 1],
      [1, 5],
      [-1, 5],
      [-1, 1],
    ]);
  });
});

test("an extent holds all points, and is none without any", () => {
  expect(extentOf([])).toBeNull();
  expect(
    extentOf([
      [1, 5],
      [-2, 7],
      [0, 6],
    ]),
  ).toEqual([-2, 5, 1, 7]);
});

test("a margin is a share of the longer side, and at least one metre", () => {
  expect(widened([0, 0, 100, 10], 0.1)).toEqual([-10, -10, 110, 20]);
  expect(widened([0, 0, 0, 0], 0.1)).toEqual([-1, -1, 1, 1]);
});

test("zones are written in whole centimetres, and never as minus zero", () => {
  expect(toCentimetres(1.23456)).toBe(1.23);
  expect(Object.is(toCentimetres(-0.001), 0)).toBe(true);
});
