// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import type { BagWork } from "../state/bag_work";
import { Button } from "./button";

/** A message that stays until what it says is over. */
export function Notice(props: {
  kind: "error" | "warning" | "info";
  text: string;
  action?: { label: string; act: () => unknown };
}) {
  const { action } = props;
  return (
    <div class={`notice ${props.kind}`} role={props.kind === "error" ? "alert" : "status"}>
      <span>{props.text}</span>
      {action && <Button label={action.label} onClick={() => void action.act()} />}
    </div>
  );
}

/** Why something was refused; nothing where it was not. */
export function Problem({ text }: { text: string | null | undefined }) {
  return text ? (
    <p class="problem" role="alert">
      {text}
    </p>
  ) : null;
}

/** What to know of something, a line each. */
export function Notes({ notes }: { notes: readonly string[] }) {
  return notes.map((note) => (
    <p key={note} class="quiet">
      {note}
    </p>
  ));
}

const SHOWN_MS = 6000;

/** What just happened, said once and then gone. */
export function Toast({ message }: { message: Signal<string> }) {
  const text = message.value;
  useEffect(() => {
    const timer = setTimeout(() => (message.value = ""), SHOWN_MS);
    return () => clearTimeout(timer);
  }, [text]);
  return (
    <p class="toast" role="status" aria-live="polite">
      {text}
    </p>
  );
}

/** A name that goes on in the next line behind its folders and words, and before its ending. */
export function Breakable({ name }: { name: string }) {
  return name.split(/(?<=[/_-])|(?=\.\w+$)/).map((part, at) => (
    <>
      {at > 0 && <wbr />}
      {part}
    </>
  ));
}

/** How far work on a recording is, and the button that ends it; or why it failed. */
export function WorkProgress<T>({ work, doing }: { work: BagWork<T>; doing: string }) {
  const state = work.state.value;
  if (state.kind === "failed") {
    return <Problem text={state.why} />;
  }
  if (state.kind === "idle") return <p role="status">{state.note}</p>;
  if (state.kind !== "running") return null;
  return (
    <div class="row work">
      <span role="status">{doing} …</span>
      <progress max={1} value={state.share} aria-label={doing} />
      <span class="number">{Math.round(100 * state.share)} %</span>
      <Button label="Cancel" onClick={() => work.cancel()} />
    </div>
  );
}
