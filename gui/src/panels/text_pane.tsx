// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import type { PlacedFinding } from "../api/types";
import type { RuleEditor } from "../state/rule_editor";
import { TextEditor } from "../text/text_editor";

/** The rules as text, which is what is saved. */
export function TextPane({ editor, hidden }: { editor: RuleEditor; hidden: boolean }) {
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
