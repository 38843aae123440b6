// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { OpenTabs } from "../../src/state/drafts";

/** The tabs that are open, the locks that are held, and how long a tab takes to read what others say. */
let channels: Channel[] = [];
let held: string[] = [];
let answersAfterMs = 0;

class Channel {
  onmessage: (event: { data: unknown }) => void = () => undefined;

  constructor() {
    channels.push(this);
  }

  postMessage(data: unknown): void {
    for (const other of channels) if (other !== this) setTimeout(() => other.onmessage({ data }), answersAfterMs);
  }
}

const locks = {
  request: async (name: string) => void held.push(name),
  query: async () => ({ held: held.map((name) => ({ name })) }),
};

beforeEach(() => {
  vi.useFakeTimers();
  [channels, held, answersAfterMs] = [[], [], 0];
  vi.stubGlobal("BroadcastChannel", Channel);
  vi.stubGlobal("navigator", { locks });
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

/** The other tabs that the first one hears of, and after how long. */
async function heard(tabs: readonly OpenTabs[]): Promise<[string[], number]> {
  const beganMs = performance.now();
  const others = tabs[0]?.others() ?? Promise.resolve(new Set<string>());
  await vi.runAllTimersAsync();
  const ms = await others.then(() => performance.now() - beganMs);
  return [[...(await others)], ms];
}

test("a tab that is open and busy is waited for", async () => {
  const tabs = [new OpenTabs("a"), new OpenTabs("b")];
  answersAfterMs = 400;
  expect((await heard(tabs))[0]).toEqual(["b"]);
});

test("a tab that is open and never answers is not waited for without end", async () => {
  const tabs = [new OpenTabs("a"), new OpenTabs("b")];
  channels[1] = new Channel();
  const [others, ms] = await heard(tabs);
  expect(others).toEqual([]);
  expect(ms).toBeLessThan(5000);
});

test("a tab that was closed costs no more than a moment", async () => {
  const tabs = [new OpenTabs("a"), new OpenTabs("b")];
  channels.length = 1;
  held = ["ruler-tab a"];
  const beganMs = performance.now();
  const others = tabs[0]?.others();
  await vi.advanceTimersByTimeAsync(150);
  expect([...((await others) ?? [])]).toEqual([]);
  expect(performance.now() - beganMs).toBe(150);
});

test("a browser that lets pages keep nothing gives no lock, and no error", async () => {
  const refused = vi.fn(async () => Promise.reject(new Error("denied")));
  vi.stubGlobal("navigator", { locks: { request: refused } });
  expect(new OpenTabs("a").own).toBe("a");
  await vi.runAllTimersAsync();
  expect(refused).toHaveBeenCalled();
});

test("where the browser has no locks, those count that answer in a moment", async () => {
  vi.stubGlobal("navigator", {});
  expect((await heard([new OpenTabs("a"), new OpenTabs("b")]))[0]).toEqual(["b"]);
});
