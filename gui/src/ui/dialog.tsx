// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentChildren } from "preact";
import { useLayoutEffect, useRef, useState } from "preact/hooks";
import { refusalOf } from "../api/client";
import { Button } from "./button";
import { Problem } from "./notice";

/** A modal form that says why it was refused. The browser's own dialog keeps the focus inside and closes on Escape. */
export function FormDialog(props: {
  title: string;
  submit: string;
  isWide?: boolean;
  canSubmit?: boolean;
  /** Whether there is nothing to cancel. */
  isNotice?: boolean;
  /** What was refused besides. */
  problem?: string;
  onSubmit: (form: FormData) => unknown;
  onClose: () => void;
  children: ComponentChildren;
}) {
  const dialog = useRef<HTMLDialogElement>(null);
  const [refused, setRefused] = useState("");
  const submit = async (form: FormData) => {
    setRefused(await refusalOf(async () => props.onSubmit(form)));
  };
  // At once, so that the next key is the field's.
  useLayoutEffect(() => {
    const shown = dialog.current;
    shown?.showModal();
    return () => {
      // Closing gives the focus back to what opened it, which may be gone or disabled with the next picture.
      shown?.close();
      focusPageSoon();
    };
  }, []);
  return (
    <dialog ref={dialog} class={props.isWide ? "wide" : ""} aria-label={props.title} onClose={props.onClose}>
      <form
        onSubmit={(event) => {
          event.preventDefault();
          void submit(new FormData(event.currentTarget));
        }}
      >
        <h2>{props.title}</h2>
        {props.children}
        <Problem text={props.problem || refused} />
        <div class="row end">
          {!props.isNotice && <Button label="Cancel" onClick={() => dialog.current?.close()} />}
          <button type="submit" class="primary" disabled={props.canSubmit === false}>
            {props.submit}
          </button>
        </div>
      </form>
    </dialog>
  );
}

/** The name that somebody typed, with the ending of such files. */
export function typedName(form: FormData, ending: string): string {
  const typed = String(form.get("name")).trim();
  return typed.endsWith(ending) ? typed : typed + ending;
}

/** Gives the focus to the page where nothing has it, once it shows what comes next. */
export function focusPageSoon(): void {
  requestAnimationFrame(() => requestAnimationFrame(focusPage));
}

function focusPage(): void {
  const holder = document.activeElement;
  if (holder === document.body || holder?.matches(":disabled")) document.querySelector<HTMLElement>("h1")?.focus();
}
