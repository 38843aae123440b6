// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentType } from "preact";
import { useEffect, useState } from "preact/hooks";
import { refusal } from "../api/client";
import { useRobot } from "./connection";

/** A component that is loaded when it is shown first, or before that. */
export type Later<P> = ComponentType<P> & { preload(): void };

export function later<P extends object>(load: () => Promise<ComponentType<P>>): Later<P> {
  let loaded: ComponentType<P> | null = null;
  function Shown(props: P) {
    const Component = useLoaded(async () => {
      loaded = await load();
      return loaded;
    }, loaded);
    return Component === null ? <p class="quiet center">Loading …</p> : <Component {...props} />;
  }
  return Object.assign(Shown, { preload: () => void load() });
}

/** What is loaded when it is shown first, unless it is `known`: null until then. */
export function useLoaded<T>(load: () => Promise<T>, known: T | null = null): T | null {
  const [loaded, setLoaded] = useState<T | null>(() => known);
  const returns = useRobot().returns.value;
  useEffect(() => {
    // Of a server that is gone nothing can be loaded until it is back.
    if (loaded === null) void load().then((one) => setLoaded(() => one));
  }, [returns]);
  return loaded;
}

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
