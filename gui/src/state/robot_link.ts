// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { batch, computed, signal } from "@preact/signals";
import { LiveSocket } from "../api/live";
import { type Live, PROTOCOL_VERSION, type Push, type Robots } from "../api/live_types";
import { connectionOf, type ServerState } from "./connection";
import { RateRings } from "./rate_rings";

const UPDATE_HZ = 5;
const TICK_MS = 1000;
const SAMPLE_MS = 1000 / UPDATE_HZ;
const STORAGE_KEY = "robot";

/** What this page knows of running robots, over one web socket that connects again by itself. */
export class RobotLink {
  readonly server = signal<ServerState>({ kind: "opening" });
  readonly robots = signal<Robots | null>(null);
  /** The newest values of the watched robot, only while it is heard. */
  readonly live = computed(() => (this.connection.value.kind === "connected" ? this.newest.value : null));
  /** Rates of the last 48 s. */
  readonly rates = new RateRings();
  readonly node = computed(() => chosenOf(this.robots.value, this.choice.value));
  readonly robot = computed(() => this.robots.value?.robots.find(({ node }) => node === this.node.value) ?? null);
  readonly connection = computed(() => {
    const sinceToldS = Math.max(0, this.nowMs.value - this.toldMs.value) / 1000;
    return connectionOf(this.server.value, this.robots.value, this.node.value, sinceToldS);
  });
  private readonly newest = signal<Live | null>(null);
  private readonly choice = signal<string | null>(localStorage.getItem(STORAGE_KEY));
  private readonly nowMs = signal(0);
  private readonly toldMs = signal(0);
  private readonly socket = new LiveSocket(this);
  private sampledMs = 0;
  private watchers = 0;
  private watched: string | null = null;

  open(): void {
    this.socket.open();
    window.setInterval(() => (this.nowMs.value = performance.now()), TICK_MS);
  }

  choose(node: string): void {
    localStorage.setItem(STORAGE_KEY, node);
    this.choice.value = node;
    this.tellWatched();
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
    if (push.kind === "hello") this.greet(push.version, push.protocol);
    else if (this.server.peek().kind !== "open") return;
    else if (push.kind === "robots") this.take(push);
    else if (push.kind === "live" && push.node === this.watched) this.show(push);
  }

  lost(): void {
    batch(() => {
      this.server.value = { kind: "lost" };
      this.robots.value = null;
      this.forget(null);
    });
  }

  private greet(version: string, protocol: number): void {
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
    const nowMs = performance.now();
    if (nowMs - this.sampledMs >= SAMPLE_MS / 2) {
      this.rates.push(live.topics);
      this.sampledMs = nowMs;
    }
    this.newest.value = live;
  }

  private tellWatched(): void {
    const wanted = this.watchers > 0 ? this.node.peek() : null;
    if (wanted === this.watched || this.server.peek().kind !== "open") return;
    this.forget(wanted);
    this.socket.send({ kind: "watch", node: wanted, update_hz: UPDATE_HZ });
  }

  private forget(next: string | null): void {
    this.watched = next;
    this.newest.value = null;
    this.rates.clear();
  }
}

/** The robot that was chosen if there is one, else the first that is heard, else the first. */
function chosenOf(robots: Robots | null, choice: string | null): string | null {
  const all = robots?.robots ?? [];
  const chosen = all.find(({ node }) => node === choice) ?? all.find((robot) => robot.is_heard) ?? all[0];
  return chosen?.node ?? null;
}
