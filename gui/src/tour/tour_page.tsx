// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { useEffect, useLayoutEffect, useMemo, useRef, useState } from "preact/hooks";
import { Api, ApiError } from "../api/client";
import type { FileAnswer, FoundFile, Project } from "../api/types";
import { EditorPage } from "../pages/editor";
import type { PageProps } from "../pages/page_props";
import { toRoute } from "../route";
import { type DraftStorage, LocalDrafts } from "../state/drafts";
import { OpenEditors } from "../state/open_editors";
import { Button } from "../ui/button";
import { focusPageSoon } from "../ui/dialog";
import { useWindowEvent } from "../ui/watch";
import rules from "./example.adirf?raw";
import parameters from "./example.toml?raw";

/** The editor on an example that is in no file, and the tour of it; `rules` is the file that it was called from. */
export function TourPage({ project, refresh, rules, keptIncidents }: PageProps) {
  const own = useMemo(() => {
    const api = new ExampleApi();
    // No draft is kept of the example.
    const editors = new OpenEditors(api, new LocalDrafts(FORGETTING, "example", "", () => false));
    return { api, editors, project: exampleProject(project) };
  }, []);
  useEffect(() => focusPageSoon, []);
  const end = () => toRoute(rules === undefined ? { page: "home", name: "" } : { page: "rules", name: rules });
  return (
    <div class="touring">
      <EditorPage {...own} {...{ refresh, keptIncidents }} name={EXAMPLE_RULES} />
      <TourCard onEnd={end} />
    </div>
  );
}

export const EXAMPLE_RULES = "example.adirf";
const EXAMPLE_PARAMETERS = "example.toml";
const TEXTS: Readonly<Record<string, string>> = { [EXAMPLE_RULES]: rules, [EXAMPLE_PARAMETERS]: parameters };

/** The server, but for files: the example is in none, and none of the project's is read or written. */
export class ExampleApi extends Api {
  override async read(name: string): Promise<FileAnswer> {
    const text = TEXTS[name];
    if (text === undefined) throw refusal(404, `${name} is not part of the example`);
    return { name, text, hash: "" };
  }

  override async fileState() {
    return { hash: "" };
  }

  override async draft() {
    return { draft: null };
  }

  override async save(): Promise<never> {
    throw refusal(403, "The example is not saved");
  }

  override async push(): Promise<never> {
    throw refusal(403, "The example is not sent to a robot");
  }

  override async profileFor() {
    return { name: EXAMPLE_PARAMETERS, gone: null };
  }

  override async chooseProfile(_rules: string, name: string | null) {
    return { name, gone: null };
  }

  override async versions() {
    return { folder: "", versions: [], most: 0 };
  }
}

/** The project as the example sees it: two files of its own, and the recordings that rules can be tried on. */
function exampleProject(project: Project): Project {
  const own = (name: string, kind: FoundFile["kind"]) => ({ name, kind, size_bytes: 0, changed_at_s: 0 });
  return {
    ...project,
    files: [
      own(EXAMPLE_RULES, "rules"),
      own(EXAMPLE_PARAMETERS, "profile"),
      ...project.files.filter(({ kind }) => kind === "bag"),
    ],
  };
}

const FORGETTING: DraftStorage = {
  length: 0,
  key: () => null,
  getItem: () => null,
  setItem: () => undefined,
  removeItem: () => undefined,
};

function refusal(status: number, message: string): ApiError {
  const remedy = "New Rule File on the first screen makes rules of your own";
  return new ApiError(status, { message, remedy, place: "", findings: [] });
}

/** What the tour says at one step, beside a ring around what it is about; the page can be used meanwhile. */
function TourCard({ onEnd }: { onEnd: () => void }) {
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
  useWindowEvent("keydown", (event) => {
    const isFree = event.target instanceof Element && event.target.closest("input, dialog, .cm-editor") === null;
    if (event.key === "Escape" && !event.defaultPrevented && isFree) end();
  });
}

const pixels = (box: object) => Object.fromEntries(Object.entries(box).map(([name, px]) => [name, `${px}px`]));

/** A part of the window, in CSS pixels. */
export interface Box {
  left: number;
  top: number;
  width: number;
  height: number;
}

interface Size {
  width: number;
  height: number;
}

const GAP_PX = 14;
const NARROW_PX = 600;

/**
 * Where a card goes that points at `part`: beside it, below or above, where it fits whole, else into its lower right
 * corner; on a telephone at the foot of the window.
 */
export function placed(part: Box, card: Size, view: Size): { left: number; top: number } {
  const foot = view.height - card.height - GAP_PX;
  if (view.width <= NARROW_PX) return { left: (view.width - card.width) / 2, top: foot };
  const [right, bottom] = [part.left + part.width, part.top + part.height];
  const within = (wanted: number, most: number) => Math.max(GAP_PX, Math.min(wanted, most));
  const left = within(part.left, view.width - card.width - GAP_PX);
  const top = within(part.top + GAP_PX, foot);
  const beside = [
    { left: right + GAP_PX, top },
    { left: part.left - card.width - GAP_PX, top },
  ];
  const belowOrAbove = [
    { left, top: bottom + GAP_PX },
    { left, top: part.top - card.height - GAP_PX },
  ];
  // Beside a bar the card would cover its neighbours.
  const choices = part.height < card.height ? [...belowOrAbove, ...beside] : [...beside, ...belowOrAbove];
  const fits = (at: { left: number; top: number }) =>
    at.left >= 0 && at.top >= 0 && at.left + card.width <= view.width && at.top + card.height <= view.height;
  return (
    choices.find(fits) ?? {
      left: within(right - card.width - GAP_PX, view.width - card.width - GAP_PX),
      top: within(bottom - card.height - GAP_PX, foot),
    }
  );
}

/** The part of `box` that is inside the window. */
export function shownPart(box: Box, view: Size): Box {
  const left = Math.max(0, box.left);
  const top = Math.max(0, box.top);
  const width = Math.max(0, Math.min(view.width, box.left + box.width) - left);
  const height = Math.max(0, Math.min(view.height, box.top + box.height) - top);
  return { left, top, width, height };
}

/** A step of the tour: what it says, and the part of the page that it points at. */
interface TourStep {
  title: string;
  text: string;
  /** Finds that part by what it is called on the page. */
  part: string;
}

const UNFOLD = '[role="group"][aria-label="Unfold"]';

/** The tour of the editor, for people who do not program. */
const STEPS: readonly TourStep[] = [
  {
    title: "Rules are blocks",
    text:
      "A blue block says how often one topic of the robot is sent when nothing special happens. The brown block is a " +
      "rule: IF all of its green checks hold, THEN other rates apply. Here the operator sees more while the robot is " +
      "at the loading dock. Click a white field to change it; this is an example, and nothing of it is saved.",
    part: '[aria-label="Blocks"]',
  },
  {
    title: "The same as text",
    text:
      "Text unfolds the same rules as text: change whichever you like, Undo covers both. Map shows where rules hold as " +
      "rectangles that you can draw and drag. What you unfold stays open until you fold it.",
    part: UNFOLD,
  },
  {
    title: "What is wrong or doubtful",
    text:
      "The findings check your rules while you work and mark the place. Here /imu has no rate of its own outside the " +
      "loading dock. Findings unfolds all of them; many are mended with one click, and Why? explains them.",
    part: UNFOLD,
  },
  {
    title: "Try before you trust",
    text:
      "Try plays a recording of your robot and shows what the rules would have sent, and what the operator would have " +
      "lost. No robot is needed, and nothing is changed.",
    part: UNFOLD,
  },
  {
    title: "Send or download",
    text:
      "Optimize and Download turns words such as Desirable into rates that fit your radio link. With a robot, Send to " +
      "robot shows what would change, tries it for ten seconds, and goes back by itself unless you keep it. New Rule " +
      "File, on the first screen, is where your own rules begin.",
    part: '[role="group"][aria-label="Send or download"]',
  },
];
