// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentChildren } from "preact";
import { useMemo } from "preact/hooks";
import { unquoted } from "../blocks/compared";
import { scrubOn, type Timeline } from "../state/timeline";
import { durationWords } from "../ui/numbers";

/** From when on something was a word, in s; null where it was unknown. */
export type Words = readonly (readonly [number, string | null])[];

interface Props {
  timeline: Timeline;
  words: Words;
  /** What the words are compared with, as a rule file spells it. */
  compared: string;
  label: string;
  children: ComponentChildren;
}

/** The words that a check read over time, one behind the other; pressing or dragging on them moves the time. */
export function WordLane({ timeline, words, compared, label, children }: Props) {
  const { durationS } = timeline;
  const parts = useMemo(() => partsOf(words, durationS), [words, durationS]);
  const wanted = compared.startsWith('"') ? unquoted(compared) : compared;
  const scrub = (event: PointerEvent) => scrubOn(event, timeline);
  const share = (timeS: number) => `${(100 * timeS) / (durationS || 1)}%`;
  return (
    <figure class="strip">
      <figcaption>{children}</figcaption>
      <div
        class="word-lane"
        role="img"
        aria-label={`${label}: ${totalsOf(parts)}`}
        onPointerDown={scrub}
        onPointerMove={scrub}
      >
        {parts.map(({ word, fromS, toS }) => (
          <span
            key={fromS}
            class={word === null ? "unknown" : word === wanted ? "wanted" : undefined}
            style={{ left: share(fromS), width: share(toS - fromS) }}
            title={`${word ?? "unknown"} for ${durationWords(toS - fromS)}`}
          >
            {word ?? "?"}
          </span>
        ))}
        <i style={{ left: share(timeline.time.value) }} />
      </div>
    </figure>
  );
}

interface Part {
  word: string | null;
  fromS: number;
  toS: number;
}

function partsOf(words: Words, durationS: number): Part[] {
  return words
    .map(([fromS, word], at) => ({ word, fromS, toS: Math.min(words[at + 1]?.[0] ?? durationS, durationS) }))
    .filter(({ fromS, toS }) => toS > fromS);
}

/** `docking for 12 s, driving for 30 s`: the words in the order of their first time. */
function totalsOf(parts: readonly Part[]): string {
  const seconds = new Map<string, number>();
  for (const { word, fromS, toS } of parts) {
    const shown = word ?? "unknown";
    seconds.set(shown, (seconds.get(shown) ?? 0) + toS - fromS);
  }
  return [...seconds].map(([word, total]) => `${word} for ${durationWords(total)}`).join(", ") || "no values";
}
