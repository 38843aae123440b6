// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** How long tabs have to answer; one that was frozen does not, and one that is closed cannot. */
const ANSWER_WITHIN_MS = 150;

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
  }

  /** The other tabs that answer now. */
  async others(): Promise<ReadonlySet<string>> {
    this.heard.clear();
    this.say({ kind: "who" });
    await new Promise((done) => setTimeout(done, ANSWER_WITHIN_MS));
    return new Set(this.heard);
  }

  private say(call: Call): void {
    this.channel.postMessage(call);
  }
}
