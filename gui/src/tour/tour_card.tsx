// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import { Button } from "../ui/button";
import { type Box, placed, shownPart } from "./placement";
import { STEPS } from "./steps";

/** What the tour says at one step, beside a ring around what it is about; the page can be used meanwhile. */
export function TourCard({ onEnd }: { onEnd: () => void }) {
  const [at, setAt] = useState(0);
  const card = useRef<HTMLElement>(null);
  const next = useRef<HTMLButtonElement>(null);
  const step = STEPS[at];
  const part = useBox(step?.part ?? "", card);
  useEffect(() => next.current?.focus(), []);
  useEscape(onEnd);
  if (step === undefined) return null;
  const isLast = at === STEPS.length - 1;
  return (
    <>
      {part && <div class="tour-ring" style={pixels(part.ring)} />}
      <section
        ref={card}
        class="tour-card"
        role="dialog"
        aria-modal="false"
        aria-label="Tour"
        aria-describedby="tour-words"
        style={part ? pixels(part.card) : undefined}
      >
        <div id="tour-words" aria-live="polite" aria-atomic="true">
          <p class="quiet">
            Step {at + 1} of {STEPS.length}
          </p>
          <h2>{step.title}</h2>
          <p>{step.text}</p>
        </div>
        <div class="row end">
          <Button label="Skip the tour" class="link tour-skip" hidden={isLast} onClick={onEnd} />
          <Button label="Back" hidden={at === 0} onClick={() => setAt(at - 1)} />
          <button type="button" class="primary" ref={next} onClick={() => (isLast ? onEnd() : setAt(at + 1))}>
            {isLast ? "Finish" : "Next"}
          </button>
        </div>
      </section>
    </>
  );
}

interface Placed {
  ring: Box;
  card: { left: number; top: number };
}

/** Where the part of the page and the card are, for as long as either moves; null until the part is there. */
function useBox(selector: string, card: { current: HTMLElement | null }): Placed | null {
  const [found, setFound] = useState<Placed | null>(null);
  useLayoutEffect(() => {
    let shown = "";
    let isSeen = false;
    const look = () => {
      const part = document.querySelector<HTMLElement>(selector);
      if (part !== null && card.current !== null) {
        if (!isSeen) part.scrollIntoView({ block: "start" });
        isSeen = true;
        const view = { width: innerWidth, height: innerHeight };
        const ring = shownPart(part.getBoundingClientRect(), view);
        const now = { ring, card: placed(ring, card.current.getBoundingClientRect(), view) };
        const key = JSON.stringify(now);
        if (key !== shown) setFound(now);
        shown = key;
      }
      frame = requestAnimationFrame(look);
    };
    let frame = requestAnimationFrame(look);
    return () => cancelAnimationFrame(frame);
  }, [selector]);
  return found;
}

/** Ends the tour with Escape, unless it closes something else first. */
function useEscape(end: () => void): void {
  const ending = useRef(end);
  ending.current = end;
  useEffect(() => {
    const pressed = (event: KeyboardEvent) => {
      const isFree = event.target instanceof Element && event.target.closest("input, dialog, .cm-editor") === null;
      if (event.key === "Escape" && !event.defaultPrevented && isFree) ending.current();
    };
    addEventListener("keydown", pressed);
    return () => removeEventListener("keydown", pressed);
  }, []);
}

const pixels = (box: object) => Object.fromEntries(Object.entries(box).map(([name, px]) => [name, `${px}px`]));
