// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect } from "@preact/signals";
import { useEffect, useMemo, useRef } from "preact/hooks";
import type { PlacedFinding } from "../api/types";
import { MapFloor } from "../state/map_floor";
import type { RuleEditor } from "../state/rule_editor";
import type { ZoneEditor } from "../state/zone_editor";
import type { TextEditor } from "../text/text_editor";
import { useRobot } from "../ui/connection";
import { useLoaded } from "../ui/later";
import { type FullScreen, FullScreenButton, type Side } from "../ui/panes";
import { FloorChoice, MapPanel } from "./map_panel";

/** Beside the blocks: the rules as text, or their zones on a map. */
export function SidePane(props: { editor: RuleEditor; zones: ZoneEditor; side: Side; full: FullScreen }) {
  const { editor, zones, side, full } = props;
  const floor = useMemo(() => new MapFloor(editor), []);
  const isMap = side === "map";
  const hasText = useRef(!isMap);
  if (!isMap) hasText.current = true;
  const returns = useRobot().returns.value;
  useEffect(() => (isMap ? floor.follow() : undefined), [isMap, returns]);
  useEffect(() => {
    if (!isMap && full.part.peek() === "map") full.leave();
  }, [isMap]);
  return (
    <div class="pane side">
      {isMap && (
        <div class="pane-bar">
          <FullScreenButton full={full} part="map" />
          <FloorChoice {...{ floor, editor }} />
        </div>
      )}
      {hasText.current && <TextPane editor={editor} hidden={isMap} />}
      {isMap && <MapPanel {...{ editor, zones, floor }} />}
    </div>
  );
}

/** The rules as text, which is what is saved. */
function TextPane({ editor, hidden }: { editor: RuleEditor; hidden: boolean }) {
  const host = useRef<HTMLDivElement>(null);
  const loaded = useLoaded(() => import("../text/text_editor"));
  useEffect(() => (host.current && loaded ? openText(loaded.TextEditor, host.current, editor) : undefined), [loaded]);
  return (
    <section class="side-part" aria-label="Text" hidden={hidden}>
      <div class="text-host" ref={host} />
    </section>
  );
}

function openText(Editor: typeof TextEditor, host: HTMLElement, editor: RuleEditor): () => void {
  const owner = {
    typed: (value: string) => editor.type(value),
    left: () => void editor.format(),
    cursorAt: (offset: number) => {
      editor.spot.value = { offset, end_offset: offset, from: "text" };
    },
    fix: (finding: PlacedFinding) => void editor.fix(finding),
    vocabulary: () => editor.words.offered(),
  };
  const text = new Editor(host, owner, editor.text.peek());
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
