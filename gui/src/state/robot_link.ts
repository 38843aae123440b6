// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { batch, computed, effect, signal } from "@preact/signals";
import { LiveSocket } from "../api/live";
import { type Hello, type Live, PROTOCOL_VERSION, type Push, type Robots } from "../api/types";
import { connectionOf, type ServerState, TOLD_WITHIN_S } from "./connection";
import { RateRings, RING_LENGTH } from "./rate_rings";

/** How often a robot's values can be asked for; the second is usual. */
export const UPDATE_RATES_HZ = [1, 5, 20];
const USUAL_HZ = 5;
const TICK_MS = 1000;
const SAMPLE_MS = 200;
/** After so long without a status the server calls a robot silent, or later where it sends less than one a second. */
const SILENT_AFTER_MS = 2400;
const NODE_KEY = "robot";
const WATCHES_KEY = "may only watch";
const RATE_KEY = "updates of the robot in Hz";

/** What this page knows of running robots, over one web socket that connects again by itself. */
export class RobotLink {
  readonly server = signal<ServerState>({ kind: "opening" });
  readonly robots = signal<Robots | null>(null);
  /** The newest values of the watched robot, only while it is heard. */
  readonly live = computed(() => (this.connection.value.kind === "connected" ? this.newest.value : null));
  /** The same, at most five times a second: for what is read and not watched. */
  readonly calm = computed(() => {
    void this.samples.value;
    return this.connection.value.kind === "connected" ? this.newest.peek() : null;
  });
  /** Rates of the last 48 s. */
  readonly rates = new RateRings();
  /** Counts what came into `rates`. */
  readonly samples = signal(0);
  readonly node = computed(() => chosenOf(this.robots.value, this.choice.value));
  readonly robot = computed(() => this.robots.value?.robots.find(({ node }) => node === this.node.value) ?? null);
  /** How old `robots` is. */
  readonly sinceToldS = computed(() => Math.max(0, this.nowMs.value - this.toldMs.value) / 1000);
  readonly connection = computed(() =>
    connectionOf(this.server.value, this.robots.value, this.node.value, this.sinceToldS.value),
  );
  /** Whether the server ended, cannot be reached, or says nothing any more. */
  readonly isServerGone = computed(
    () =>
      this.server.value.kind === "lost" ||
      (this.server.value.kind === "open" && this.robots.value !== null && this.sinceToldS.value > TOLD_WITHIN_S),
  );
  /** Since when the server is gone, in ms since 1970; null while it is there. */
  readonly goneSinceMs = signal<number | null>(null);
  /** How often the server came back. */
  readonly returns = signal(0);
  /** Whether whoever looks at this page may change neither files nor robots. */
  readonly onlyWatches = signal(false);
  private readonly newest = signal<Live | null>(null);
  readonly updateHz = signal(Number(localStorage.getItem(RATE_KEY)) || USUAL_HZ);
  private readonly choice = signal<string | null>(localStorage.getItem(NODE_KEY));
  private readonly nowMs = signal(0);
  private readonly toldMs = signal(0);
  private readonly socket = new LiveSocket(this);
  private sampledMs = 0;
  private watchers = 0;
  private watched: string | null = null;

  open(): void {
    this.socket.open();
    window.setInterval(() => this.tick(), TICK_MS);
    effect(() => this.noteServer(this.isServerGone.value));
    // Another tab got another token, which is this one's as well.
    addEventListener("storage", ({ key, newValue }) => {
      if (key === WATCHES_KEY) this.onlyWatches.value = newValue === "true";
    });
  }

  choose(node: string): void {
    localStorage.setItem(NODE_KEY, node);
    this.choice.value = node;
    this.tellWatched();
  }

  /** Asks for so many updates a second from now on. */
  updateAt(rateHz: number): void {
    localStorage.setItem(RATE_KEY, String(rateHz));
    this.updateHz.value = rateHz;
    this.sendWatched();
  }

  /** Asks for live values until the returned function is called. */
  watch(): () => void {
    this.watchers++;
    this.tellWatched();
    return () => {
      this.watchers--;
      this.tellWatched();
    };
  }

  heard(push: Push): void {
    if (push.kind === "hello") this.greet(push);
    else if (this.server.peek().kind !== "open") return;
    else if (push.kind === "robots") this.take(push);
    else if (push.kind === "live" && push.node === this.watched) this.show(push);
  }

  lost(needsToken: boolean): void {
    batch(() => {
      this.server.value = { kind: "lost", needsToken };
      this.robots.value = null;
      this.forget(null);
    });
  }

  private tick(): void {
    // Of a computer that stood still, what the server told meanwhile is read after this.
    this.nowMs.value = Math.min(performance.now(), this.nowMs.peek() + 2 * TICK_MS);
  }

  private noteServer(isGone: boolean): void {
    if (!isGone && this.goneSinceMs.peek() !== null) this.returns.value = this.returns.peek() + 1;
    this.goneSinceMs.value = isGone ? Date.now() : null;
  }

  private greet({ version, protocol, only_watches }: Hello): void {
    this.onlyWatches.value = only_watches;
    localStorage.setItem(WATCHES_KEY, String(only_watches));
    this.server.value = protocol === PROTOCOL_VERSION ? { kind: "open" } : { kind: "other", version };
    this.tellWatched();
  }

  private take(robots: Robots): void {
    batch(() => {
      this.robots.value = robots;
      this.toldMs.value = this.nowMs.value = performance.now();
    });
    this.tellWatched();
  }

  private show(live: Live): void {
    const due = Math.floor((performance.now() - this.sampledMs) / SAMPLE_MS);
    const { topics, status_hz } = live.status;
    const isAfterSilence = due * SAMPLE_MS > SILENT_AFTER_MS * Math.max(1, 1 / status_hz);
    for (let left = Math.min(due, RING_LENGTH); left > 0; left--) {
      if (isAfterSilence && left > 1) this.rates.pass();
      else this.rates.push(topics);
    }
    this.sampledMs += due * SAMPLE_MS;
    batch(() => {
      this.samples.value += due;
      this.newest.value = live;
    });
  }

  private tellWatched(): void {
    const wanted = this.watchers > 0 ? this.node.peek() : null;
    if (wanted === this.watched || this.server.peek().kind !== "open") return;
    this.forget(wanted);
    this.sendWatched();
  }

  private sendWatched(): void {
    this.socket.send({ kind: "watch", node: this.watched, update_hz: this.updateHz.peek() });
  }

  private forget(next: string | null): void {
    this.watched = next;
    this.newest.value = null;
    this.rates.clear();
    this.samples.value = this.samples.peek() + 1;
    this.sampledMs = performance.now() - SAMPLE_MS;
  }
}

/** The robot that was chosen if there is one, else the first that is heard, else the first. */
function chosenOf(robots: Robots | null, choice: string | null): string | null {
  const all = robots?.robots ?? [];
  const chosen = all.find(({ node }) => node === choice) ?? all.find((robot) => robot.is_heard) ?? all[0];
  return chosen?.node ?? null;
}
