// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { TryHeadline } from "../api/types";
import { durationWords, readable } from "../ui/numbers";

/** What the operator misses most: `/scan: 43 of 3 360, up to 2.9 s old`; empty where every message arrives. */
export function lossWords({ worst_topic: worst }: Pick<TryHeadline, "worst_topic">): string {
  if (worst === null) return "";
  const { topic, sent, received, longest_s, is_image } = worst;
  if (received === 0) return `${topic}: none of ${readable(sent)}`;
  const age = is_image ? `dark for ${durationWords(longest_s)}` : `up to ${durationWords(longest_s)} old`;
  return `${topic}: ${readable(received)} of ${readable(sent)}, ${age}`;
}

/** The RMSE of the worst property: `/odom pose_y: 0.4 m (5.1 %)`, of its range; empty where none was off. */
export function errorWords({ worst_field: worst }: Pick<TryHeadline, "worst_field">): string {
  if (worst === null) return "";
  const { topic, field, unit, rmse, share } = worst;
  const size = [readable(rmse), unit].filter(Boolean).join(" ");
  return `${topic} ${field}: ${size} (${readable(100 * share)} %)`;
}

/** `2 of 14`; empty where no threshold was crossed. */
export function missedWords(headline: Pick<TryHeadline, "crossings" | "missed_crossings">): string {
  const { crossings, missed_crossings } = headline;
  return crossings === 0 ? "" : `${readable(missed_crossings)} of ${readable(crossings)}`;
}

/** That a try is of something else than what there is now; nothing where all is the same. */
export function StaleNotice({ changed, advice }: { changed: readonly string[]; advice: string }) {
  if (changed.length === 0) return null;
  return (
    <p class="notice warning" role="status">
      Stale: {andWords(changed)} changed since. {advice}
    </p>
  );
}

/** `rules and recording`. */
function andWords(words: readonly string[]): string {
  return [words.slice(0, -1).join(", "), ...words.slice(-1)].filter(Boolean).join(" and ");
}
