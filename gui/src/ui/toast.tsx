// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Signal } from "@preact/signals";
import { useEffect } from "preact/hooks";

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
