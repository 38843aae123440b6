// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { beforeEach } from "vitest";

// Files share a process: what one test left to be done later would be done within another.
beforeEach(() => {
  const { setTimeout, setInterval } = globalThis;
  const timers: (ReturnType<typeof setTimeout> | ReturnType<typeof setInterval>)[] = [];
  const noted = <Of extends unknown[], Timer extends (typeof timers)[number]>(begin: (...of: Of) => Timer) =>
    Object.assign((...of: Of) => {
      const timer = begin(...of);
      timers.push(timer);
      return timer;
    }, begin);
  Object.assign(globalThis, { setTimeout: noted(setTimeout), setInterval: noted(setInterval) });
  return () => {
    for (const timer of timers) clearTimeout(timer);
    Object.assign(globalThis, { setTimeout, setInterval });
  };
});
