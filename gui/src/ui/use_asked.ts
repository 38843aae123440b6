// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useState } from "preact/hooks";
import { refusal } from "../api/client";

const ASK_EVERY_MS = 2000;

/** What `ask` answers, anew every two seconds and when one of `about` changes; an older answer stays meanwhile. */
export function useAsked<T>(ask: () => Promise<T>, about: readonly [string, ...unknown[]]): T | null {
  const [answer, setAnswer] = useState<{ of: string; said: T } | null>(null);
  const [of] = about;
  useEffect(() => {
    let isShown = true;
    const look = async () => {
      try {
        const said = await ask();
        if (isShown) setAnswer({ of, said });
      } catch (error) {
        // The server may be gone, and come back.
        refusal(error);
      }
    };
    void look();
    const timer = window.setInterval(() => void look(), ASK_EVERY_MS);
    return () => {
      isShown = false;
      window.clearInterval(timer);
    };
  }, about);
  return answer?.of === of ? answer.said : null;
}
