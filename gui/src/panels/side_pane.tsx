// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect, type Signal } from "@preact/signals";
import { useEffect, useMemo, useRef } from "preact/hooks";
import type { PlacedFinding } from "../api/types";
import { MapFloor } from "../state/map_floor";
import type { RuleEditor } from "../state/rule_editor";
import type { ZoneEditor } from "../state/zone_editor";
import { TextEditor } from "../text/text_editor";
import { type Tab, Tabs } from "../ui/choice";
import { useRobot } from "../ui/connection";
import { type FullScreen, FullScreenButton } from "../ui/panes";
import { FloorChoice, MapPanel } from "./map_panel";

export type Side = "text" | "map";

const CHOICES: Tab<Side>[] = [
  { value: "text", label: "Text" },
  { value: "map", label: "Map" },
];

/** The right half: the rules as text, or their zones on a map. */
export function SidePane(props: { editor: RuleEditor; zones: ZoneEditor; side: Signal<Side>; full: FullScreen }) {
  const { editor, zones, side, full } = props;
  const floor = useMemo(() => new MapFloor(editor), []);
  const isMap = side.value === "map";
  const returns = useRobot().returns.value;
  useEffect(() => (isMap ? floor.follow() : undefined), [isMap, returns]);
  useEffect(() => {
    if (!isMap && full.part.peek() === "map") full.leave();
  }, [isMap]);
  // At once: waiting for the next picture would draw one more for each key.
  useEffect(
    () =>
      effect(() => {
        const spot = editor.spot.value;
        if (spot?.from !== "findings" || side.peek() === "text") return;
        side.value = "text";
        // The text can only scroll to a place once it is to be seen.
        requestAnimationFrame(() => (editor.spot.value = { ...spot }));
      }),
    [],
  );
  return (
    <div class="pane side">
      <div class="pane-bar">
        <Tabs label="Text or map" choices={CHOICES} chosen={side} />
        {isMap && <FullScreenButton full={full} part="map" />}
        {isMap && <FloorChoice {...{ floor, editor }} />}
      </div>
      <TextPane editor={editor} hidden={side.value !== "text"} />
      {isMap && <MapPanel {...{ editor, zones, floor }} />}
    </div>
  );
}

/** The rules as text, which is what is saved. */
function TextPane({ editor, hidden }: { editor: RuleEditor; hidden: boolean }) {
  const host = useRef<HTMLDivElement>(null);
  useEffect(() => (host.current ? openText(host.current, editor) : undefined), []);
  return (
    <section class="side-part" aria-label="Text" hidden={hidden}>
      <div class="text-host" ref={host} />
    </section>
  );
}

function openText(host: HTMLElement, editor: RuleEditor): () => void {
  const owner = {
    typed: (value: string) => editor.type(value),
    cursorAt: (offset: number) => {
      editor.spot.value = { offset, end_offset: offset, from: "text" };
    },
    fix: (finding: PlacedFinding) => void editor.fix(finding),
    vocabulary: () => editor.words.offered(),
  };
  const text = new TextEditor(host, owner, editor.text.peek());
  const stops = [
    effect(() => text.setText(editor.text.value)),
    effect(() => {
      const findings = editor.findings.value;
      // Findings name places of the newest text, and of two effects the other one may come later.
      text.setText(editor.text.peek());
      text.mark(findings);
    }),
    effect(() => {
      if (editor.words.vocabulary.value !== null) text.suggestAnew();
    }),
    effect(() => {
      const spot = editor.spot.value;
      if (spot === null) text.reveal(0, 0, false);
      else if (spot.from !== "text") text.reveal(spot.offset, spot.end_offset, spot.from === "findings");
    }),
  ];
  return () => {
    for (const stop of stops) stop();
    text.dispose();
  };
}
