// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** How long tabs have to answer; one that is closed cannot. */
const ANSWER_WITHIN_MS = 150;
/** How long one has that is known to be open, and may be busy. */
const OPEN_ANSWERS_WITHIN_MS = 3000;
const LOCK = "ruler-tab ";

type Call = { kind: "who" } | { kind: "here"; tab: string };

/** Which tabs have a page of this server open. */
export class OpenTabs {
  private readonly channel = new BroadcastChannel("ruler-tabs");
  private readonly heard = new Set<string>();

  constructor(readonly own: string) {
    this.channel.onmessage = ({ data }: MessageEvent<Call>) => {
      if (data.kind === "here") this.heard.add(data.tab);
      else this.say({ kind: "here", tab: this.own });
    };
    // Held until the tab is closed or crashes; a browser has locks only where it trusts the address and keeps anything.
    void navigator.locks?.request(LOCK + own, () => new Promise(() => undefined)).catch(() => undefined);
  }

  /** The other tabs that answer now. */
  async others(): Promise<ReadonlySet<string>> {
    this.heard.clear();
    this.say({ kind: "who" });
    const askedMs = performance.now();
    do await new Promise((done) => setTimeout(done, ANSWER_WITHIN_MS));
    while (performance.now() - askedMs < OPEN_ANSWERS_WITHIN_MS && (await this.isAnyAwaited()));
    return new Set(this.heard);
  }

  /** Whether another tab is open and has not answered yet. */
  private async isAnyAwaited(): Promise<boolean> {
    const locks = (await navigator.locks?.query())?.held ?? [];
    const tabs = locks.flatMap(({ name = "" }) => (name.startsWith(LOCK) ? [name.slice(LOCK.length)] : []));
    return tabs.some((tab) => tab !== this.own && !this.heard.has(tab));
  }

  private say(call: Call): void {
    this.channel.postMessage(call);
  }
}
