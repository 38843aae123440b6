// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type { TryImages, TryLoss, TryTopicLoss } from "../../src/api/types";
import { worstLoss } from "../../src/try/worst_loss";

const topic = (name: string, sent: number, received: number, maxS: number): TryTopicLoss => ({
  topic: name,
  sent: { messages: sent, bytes: 0, age: null },
  received: {
    messages: received,
    bytes: 0,
    age: received === 0 ? null : { mean_s: 0, p95_s: 0, max_s: maxS, unseen_s: 0 },
  },
  age_s_bins: [],
});
const images = (name: string, sent: number, received: number, blindS: number): TryImages => ({
  topic: name,
  sent: { frames: sent, longest_blind_s: 0.03 },
  received: { frames: received, longest_blind_s: blindS },
});
const loss = (topics: TryTopicLoss[], shown: TryImages[] = []): TryLoss => ({
  topics,
  fields: [],
  crossings: [],
  images: shown,
});

test.each([
  [loss([topic("/scan", 100, 100, 0.2)]), ""],
  [loss([topic("/scan", 100, 50, 0.2), topic("/odom", 1000, 4, 131)]), "/odom: 4 of 1 000, up to 2.18 min old"],
  [loss([topic("/scan", 100, 50, 0.2), topic("/odom", 1000, 0, 0)]), "/odom: none of 1 000"],
  [
    loss([topic("/odom", 1000, 100, 1.2), topic("/camera", 3360, 43, 2.9)], [images("/camera", 3360, 43, 2.9)]),
    "/camera: 43 of 3 360, dark for 2.9 s",
  ],
])("the worst of %o is said as %s", (given, words) => {
  expect(worstLoss(given)).toBe(words);
});
