// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { signal } from "@preact/signals";
import { afterEach, expect, test, vi } from "vitest";
import { Api } from "../../src/api/client";
import { PLAIN_GRID } from "../../src/state/layout";
import { MapFloor } from "../../src/state/map_floor";
import { serve } from "./served";

afterEach(() => vi.unstubAllGlobals());

const SAID = { ...PLAIN_GRID, name: "floor", metres_per_pixel: 0.1, x: 1, y: 2, yaw_deg: 90 };
const FOUND = { name: "floor", hash: "h", width_px: 200, height_px: 100, x: 7, y: 8, yaw_rad: 0.5 };

test.each([
  ["map", 0.05, { width_m: 10, height_m: 5, x: 7, y: 8, yaw_rad: 0.5, is_stencil: true }],
  ["image", null, { width_m: 20, height_m: 10, x: 1, y: 2, yaw_rad: Math.PI / 2, is_stencil: false }],
] as const)("a %s lies where its own file says, and an image where somebody put it", async (kind, scale, shown) => {
  serve({ "POST /api/background": () => ({ ...FOUND, kind, metres_per_pixel: scale }) });
  const map = signal({ ...SAID, kind });
  const floor = new MapFloor({ api: new Api(), map, attempt: (work) => work() });
  const stop = floor.followPicture();
  await vi.waitFor(() => expect(floor.picture.value).toMatchObject(shown));
  stop();
});
