// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentType } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { refusalOf } from "../api/client";
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

/** An answer of the server, why there is none, how to ask again, and how to have another answer. */
interface Answered<T> {
  answer: T | null;
  problem: string;
  again: () => Promise<void>;
  take: (answer: T) => void;
}

/**
 * What `ask` answers, anew when one of `about` changes and, where that is given, `everyMs`; an older answer stays
 * meanwhile, unless it is of another thing than `of`.
 */
export function useAnswer<T>(
  ask: () => Promise<T>,
  about: readonly unknown[] = [],
  { of = "", everyMs }: { of?: string; everyMs?: number } = {},
): Answered<T> {
  const [found, setFound] = useState<{ of: string; answer: T } | null>(null);
  const [problem, setProblem] = useState("");
  const question = useRef({});
  const take = (answer: T) => setFound({ of, answer });
  const again = async () => {
    const asked = question.current;
    const isOld = () => asked !== question.current;
    const why = await refusalOf(async () => {
      const answer = await ask();
      if (!isOld()) take(answer);
    });
    if (!isOld()) setProblem(why);
  };
  useEffect(() => {
    void again();
    const timer = everyMs === undefined ? undefined : setInterval(() => void again(), everyMs);
    return () => {
      question.current = {};
      clearInterval(timer);
    };
  }, about);
  return { answer: found?.of === of ? found.answer : null, problem, again, take };
}
