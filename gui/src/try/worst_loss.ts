// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { TryLoss } from "../api/types";
import { durationWords, readable } from "../ui/numbers";

interface Loss {
  topic: string;
  sent: number;
  received: number;
  /** The longest time for which what the operator had was old, in s. */
  longestS: number;
  /** How much longer that is than at the robot; without any message, for ever. */
  moreS: number;
  isImage: boolean;
}

/** What the operator misses most: `/scan: 43 of 3 360, up to 2.9 s old`; empty where every message arrives. */
export function worstLoss({ topics, images }: TryLoss): string {
  const ofImages = images.map(
    ({ topic, sent, received }): Loss => ({
      topic,
      sent: sent.frames,
      received: received.frames,
      longestS: received.longest_blind_s,
      moreS: received.longest_blind_s - sent.longest_blind_s,
      isImage: true,
    }),
  );
  const others = topics.map(
    ({ topic, sent, received }): Loss => ({
      topic,
      sent: sent.messages,
      received: received.messages,
      longestS: received.age?.max_s ?? 0,
      moreS: (received.age?.max_s ?? Number.POSITIVE_INFINITY) - (sent.age?.max_s ?? 0),
      isImage: false,
    }),
  );
  const shown = new Set(ofImages.map(({ topic }) => topic));
  const lost = [...ofImages, ...others.filter(({ topic }) => !shown.has(topic))].filter(
    ({ sent, received }) => received < sent,
  );
  const worst = lost.reduce<Loss | undefined>((a, b) => (a && a.moreS >= b.moreS ? a : b), undefined);
  return worst === undefined ? "" : `${worst.topic}: ${wordsOf(worst)}`;
}

function wordsOf({ sent, received, longestS, isImage }: Loss): string {
  if (received === 0) return `none of ${readable(sent)}`;
  const age = isImage ? `dark for ${durationWords(longestS)}` : `up to ${durationWords(longestS)} old`;
  return `${readable(received)} of ${readable(sent)}, ${age}`;
}
