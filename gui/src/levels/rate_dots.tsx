// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef } from "preact/hooks";
import { readable } from "../ui/numbers";
import { rounded } from "./level_axis";

interface Props {
  rate_hz: number;
  /** Null where it is not known. */
  source_hz: number | null;
}

/** What a rate looks like: a dot that is seen where it was at the last message, below it one at the source's rate. */
export function RateDots({ rate_hz, source_hz }: Props) {
  return (
    <div class="rate-dots" role="group" aria-label="What a rate looks like">
      <Dot rate_hz={rate_hz} words={`${readable(rate_hz)} Hz`} />
      {source_hz !== null && <Dot rate_hz={source_hz} words={`${readable(source_hz)} Hz, as the source sends`} />}
    </div>
  );
}

/** So long a dot takes there and back. */
const ROUND_S = 4;

function Dot({ rate_hz, words }: { rate_hz: number; words: string }) {
  const dot = useRef<HTMLElement>(null);
  useEffect(() => {
    if (rate_hz <= 0 || matchMedia("(prefers-reduced-motion: reduce)").matches) return;
    const draw = (nowMs: number) => {
      if (dot.current) dot.current.style.left = `${100 * placeAt(nowMs / 1000, rate_hz)}%`;
      picture = requestAnimationFrame(draw);
    };
    let picture = requestAnimationFrame(draw);
    return () => cancelAnimationFrame(picture);
  }, [rate_hz]);
  return (
    <p>
      <span class="track" aria-hidden="true">
        <i ref={dot} />
      </span>
      <span>
        {words}: {rate_hz > 0 ? `one message each ${readable(rounded(1 / rate_hz))} s` : "no message"}
      </span>
    </p>
  );
}

/** Where a dot is seen, 0 … 1, that goes there and back and is told of `rate_hz` times a second. */
export function placeAt(timeS: number, rate_hz: number): number {
  const toldS = Math.floor(timeS * rate_hz) / rate_hz;
  return 1 - Math.abs(2 * ((toldS / ROUND_S) % 1) - 1);
}
