// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Api, ApiError } from "../api/client";
import { saveOver } from "./conflict";

/** Where blocks that somebody moved stand, by statement key; the rule file knows nothing of it. */
export type Layout = Readonly<Record<string, readonly [x: number, y: number]>>;

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

/** All that the side file holds. */
export interface SideFile {
  layout: Layout;
  map: MapSetting;
}

/** `folder/rules.adirf` → `folder/.rules.adirf.layout.json`. */
export function layoutName(name: string): string {
  const cut = name.lastIndexOf("/") + 1;
  return `${name.slice(0, cut)}.${name.slice(cut)}.layout.json`;
}

/** The saved side file; an unreadable one is empty, for it holds nothing but looks. */
export async function readLayout(api: Api, name: string): Promise<SideFile & { hash: string | null }> {
  try {
    const { text, hash } = await api.read(layoutName(name));
    return { ...sideFileOf(text), hash };
  } catch (error) {
    if (error instanceof ApiError) return { layout: {}, map: PLAIN_GRID, hash: null };
    throw error;
  }
}

/** Writes the side file and returns its hash; over what somebody else wrote there too, for it holds nothing but looks. */
export async function writeLayout(api: Api, side: string, file: SideFile, hash: string | null): Promise<string> {
  const text = `${JSON.stringify({ blocks: file.layout, map: file.map }, null, 1)}\n`;
  const done = await saveOver(api, side, text, hash);
  return "mine" in done ? (await api.save(side, text, done.hash)).hash : done.hash;
}

/** Whether there is nothing to keep in a side file. */
export function isPlain({ layout, map }: SideFile): boolean {
  return Object.keys(layout).length === 0 && map === PLAIN_GRID;
}

/** What a side file says, and the rules that a draft has beside it; what cannot be read is left out. */
export function sideFileOf(json: string): SideFile & { text?: string } {
  try {
    const { blocks, map, text } = JSON.parse(json) as { blocks?: unknown; map?: unknown; text?: unknown };
    const entries = Object.entries(blocks ?? {}).filter(([, place]) => isPlace(place));
    const side = { layout: Object.fromEntries(entries) as Layout, map: { ...PLAIN_GRID, ...likePlainGrid(map ?? {}) } };
    return typeof text === "string" ? { ...side, text } : side;
  } catch {
    return { layout: {}, map: PLAIN_GRID };
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

function isPlace(place: unknown): boolean {
  return Array.isArray(place) && place.length === 2 && place.every((number) => Number.isFinite(number));
}
