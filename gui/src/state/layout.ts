// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Api, ApiError } from "../api/client";

/** Where blocks that somebody moved stand, by statement key; the rule file knows nothing of it. */
export type Layout = Readonly<Record<string, readonly [x: number, y: number]>>;

/** `folder/rules.adirf` → `folder/.rules.adirf.layout.json`. */
export function layoutName(name: string): string {
  const cut = name.lastIndexOf("/") + 1;
  return `${name.slice(0, cut)}.${name.slice(cut)}.layout.json`;
}

/** The saved layout; an unreadable one is empty, for it holds nothing but looks. */
export async function readLayout(api: Api, name: string): Promise<{ layout: Layout; hash: string | null }> {
  try {
    const { text, hash } = await api.read(layoutName(name));
    return { layout: parseLayout(text), hash };
  } catch (error) {
    if (error instanceof ApiError) return { layout: {}, hash: null };
    throw error;
  }
}

export async function writeLayout(api: Api, side: string, layout: Layout, hash: string | null): Promise<string> {
  return (await api.save(side, `${JSON.stringify({ blocks: layout }, null, 1)}\n`, hash)).hash;
}

function parseLayout(text: string): Layout {
  try {
    const blocks: unknown = (JSON.parse(text) as { blocks?: unknown }).blocks;
    const entries = Object.entries(blocks ?? {}).filter(([, place]) => isPlace(place));
    return Object.fromEntries(entries) as Layout;
  } catch {
    return {};
  }
}

function isPlace(place: unknown): boolean {
  return Array.isArray(place) && place.length === 2 && place.every((number) => Number.isFinite(number));
}
