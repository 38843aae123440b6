// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentType } from "preact";
import { useEffect, useState } from "preact/hooks";
import { useRobot } from "./robot_state";

/** A component that is loaded when it is shown first, or before that. */
export type Later<P> = ComponentType<P> & { preload(): void };

export function later<P extends object>(load: () => Promise<ComponentType<P>>): Later<P> {
  let loaded: ComponentType<P> | null = null;
  function Shown(props: P) {
    const [, setLoaded] = useState(loaded !== null);
    const returns = useRobot().returns.value;
    useEffect(() => {
      if (loaded !== null) return;
      void load().then((component) => {
        loaded = component;
        setLoaded(true);
      });
      // Of a server that is gone nothing can be loaded until it is back.
    }, [returns]);
    if (loaded === null) return <p class="quiet center">Loading …</p>;
    const Component = loaded;
    return <Component {...props} />;
  }
  return Object.assign(Shown, { preload: () => void load() });
}

/** Opens something once its module is loaded; returns how to close it, which may be before that. */
export function onceLoaded<M>(loading: Promise<M>, open: (module: M) => () => void): () => void {
  let isLeft = false;
  let close: (() => void) | null = null;
  void loading.then((module) => {
    if (!isLeft) close = open(module);
  });
  return () => {
    isLeft = true;
    close?.();
  };
}
