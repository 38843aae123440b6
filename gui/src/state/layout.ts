// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Api, ApiError } from "../api/client";
import { baseName, folderOf } from "../ui/files";

/**
 * What zones are drawn on: a map or image, and the path of a recording.
 *
 * `hash` is that of the files when they were chosen. The rest is what a person said of an image.
 */
export interface MapSetting {
  kind: "map" | "image" | null;
  name: string;
  hash: string;
  metres_per_pixel: number;
  x: number;
  y: number;
  yaw_deg: number;
  bag: string | null;
}

export const PLAIN_GRID: MapSetting = {
  kind: null,
  name: "",
  hash: "",
  metres_per_pixel: 0.05,
  x: 0,
  y: 0,
  yaw_deg: 0,
  bag: null,
};

/** `folder/rules.adirf` → `folder/.rules.adirf.layout.json`. */
export function layoutName(name: string): string {
  return `${folderOf(name)}.${baseName(name)}.layout.json`;
}

/** The map of the saved side file; none or an unreadable one is the plain grid, for it holds nothing but looks. */
export async function readLayout(api: Api, name: string): Promise<{ map: MapSetting; hash: string | null }> {
  const side = layoutName(name);
  try {
    if ((await api.fileState(side)).hash === null) return { map: PLAIN_GRID, hash: null };
    const { text, hash } = await api.read(side);
    return { map: mapOf(text), hash };
  } catch (error) {
    if (error instanceof ApiError) return { map: PLAIN_GRID, hash: null };
    throw error;
  }
}

/** Writes the side file and returns its hash; over what somebody else wrote there too, for it holds nothing but looks. */
export async function writeLayout(api: Api, side: string, map: MapSetting, hash: string | null): Promise<string> {
  const text = `${JSON.stringify({ map }, null, 1)}\n`;
  try {
    return (await api.save(side, text, hash)).hash;
  } catch (error) {
    if (!(error instanceof ApiError) || error.status !== 409) throw error;
  }
  return (await api.save(side, text, (await api.fileState(side)).hash)).hash;
}

/** The map that a side file says; what cannot be read is left out. */
export function mapOf(json: string): MapSetting {
  try {
    const { map } = JSON.parse(json) as { map?: unknown };
    return { ...PLAIN_GRID, ...likePlainGrid(map ?? {}) };
  } catch {
    return PLAIN_GRID;
  }
}

/** The entries of a setting that are of the right type. */
function likePlainGrid(map: object): Partial<MapSetting> {
  const kinds: Record<string, unknown[]> = { kind: ["map", "image", null] };
  const entries = Object.entries(map).filter(([name, value]) => {
    const usual = (PLAIN_GRID as unknown as Record<string, unknown>)[name];
    if (name in kinds) return kinds[name]?.includes(value);
    if (name === "bag") return value === null || typeof value === "string";
    return typeof value === typeof usual && (typeof value !== "number" || Number.isFinite(value));
  });
  return Object.fromEntries(entries) as Partial<MapSetting>;
}
