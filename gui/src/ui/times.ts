// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { counted } from "./numbers";

const MOMENT = { dateStyle: "medium", timeStyle: "medium" } as const;
export const NS_PER_MS = 1_000_000;
const DAY_MS = 86_400_000;

/** A time since 1970 as day, hour, minute and second where the reader is. */
export function moment(ms: number): string {
  return new Date(ms).toLocaleString("en-GB", MOMENT);
}

/** A time since 1970 as hour and minute where the reader is. */
export function clock(ms: number, timeStyle: "short" | "medium" = "short"): string {
  return new Date(ms).toLocaleTimeString("en-GB", { timeStyle });
}

/** How long ago something was, in the words of a list: `just now`, `5 minutes ago`, `yesterday`, `3 Mar 2026`. */
export function ago(ms: number, nowMs: number): string {
  const minutes = Math.floor((nowMs - ms) / 60_000);
  if (minutes < 1) return "just now";
  if (minutes < 60) return `${counted(minutes, "minute")} ago`;
  if (minutes < 24 * 60) return `${counted(Math.floor(minutes / 60), "hour")} ago`;
  const days = Math.floor((nowMs - ms) / DAY_MS);
  if (days < 14) return days === 1 ? "yesterday" : `${counted(days, "day")} ago`;
  return new Date(ms).toLocaleDateString("en-GB", { dateStyle: "medium" });
}
