// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { batch, computed, effect, signal } from "@preact/signals";
import { LiveSocket } from "../api/live";
import {
  type Hello,
  type Live,
  PROTOCOL_VERSION,
  type Push,
  type RobotSummary,
  type Robots,
  type RulesOrigin,
} from "../api/types";
import { sentence } from "../ui/numbers";
import { duration } from "./robot_trouble";

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
  /** `live`, at most five times a second: for what is read and not watched. */
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
  readonly robotsAgeS = computed(() => Math.max(0, this.nowMs.value - this.robotsMs.value) / 1000);
  readonly connection = computed(() =>
    connectionOf(this.server.value, this.robots.value, this.node.value, this.robotsAgeS.value),
  );
  /** The worst of all robots in a few words; empty where none is an error. */
  readonly alarm = computed(() => alarmOf(this.robots.value?.robots ?? []));
  /** Whether the server ended, cannot be reached, or says nothing any more. */
  readonly isServerGone = computed(
    () =>
      this.server.value.kind === "lost" ||
      (this.server.value.kind === "open" && this.robots.value !== null && this.robotsAgeS.value > TRUSTED_FOR_S),
  );
  /** Since when the server is gone, in ms since 1970; null while it is there. */
  readonly goneSinceMs = signal<number | null>(null);
  /** How often the server came back. */
  readonly returns = signal(0);
  /** Whether this page may change neither files nor robots. */
  readonly onlyWatches = signal(false);
  private readonly newest = signal<Live | null>(null);
  readonly updateHz = signal(Number(localStorage.getItem(RATE_KEY)) || USUAL_HZ);
  private readonly choice = signal<string | null>(localStorage.getItem(NODE_KEY));
  private readonly nowMs = signal(0);
  private readonly robotsMs = signal(0);
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
    this.updateWatched();
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
    this.updateWatched();
    return () => {
      this.watchers--;
      this.updateWatched();
    };
  }

  onPush(push: Push): void {
    if (push.kind === "hello") this.greet(push);
    else if (this.server.peek().kind !== "open") return;
    else if (push.kind === "robots") this.take(push);
    else if (push.kind === "live" && push.node === this.watched) this.show(push);
  }

  onLost(needsToken: boolean): void {
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
    this.updateWatched();
  }

  private take(robots: Robots): void {
    batch(() => {
      this.robots.value = robots;
      this.robotsMs.value = this.nowMs.value = performance.now();
    });
    this.updateWatched();
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

  private updateWatched(): void {
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

/** The server tells of robots every two seconds; what is so old is no longer trusted. */
const TRUSTED_FOR_S = 8;

/** Whether the server's web socket is open, and speaks what this page understands. */
type ServerState =
  | { kind: "lost"; needsToken: boolean }
  | { kind: "opening" }
  | { kind: "open" }
  | { kind: "other"; version: string };

/** What the top of every page says of the robot: few words, and why in full. */
interface Connection {
  kind: "connected" | "silent" | "none";
  /** Whether the robot is heard and does not do what it should. */
  isFailing: boolean;
  words: string;
  why: string;
  /** What a robot that is heard does not do as it should, as a sentence; empty where all is well. */
  trouble: string;
}

/** Sums up what is known; `robotsAgeS` is how old `robots` is. */
function connectionOf(server: ServerState, robots: Robots | null, node: string | null, robotsAgeS: number): Connection {
  if (server.kind === "lost") {
    const why = server.needsToken ? "no longer takes this browser's token" : "does not answer";
    return none(`The Ruler's server ${why}. The page reconnects by itself.`);
  }
  if (server.kind === "other") {
    return none(
      `The server is SmartTestudo ${server.version}, which needs another version of this page. Reload the page.`,
    );
  }
  if (server.kind === "opening" || robots === null) return none("Waiting for the server's list of robots.");
  const robot = robots.robots.find((each) => each.node === node);
  if (robots.problem !== null && !robot) return none(robots.problem);
  if (!robot) return none("No robot found. Start 'testudo run' on the robot, in the ROS domain of this server.");
  return connectionTo(robot, robotsAgeS);
}

/** After so long silent, a robot is no longer one that rules would be sent to. */
const EXPECTED_FOR_S = 600;

function alarmOf(robots: readonly RobotSummary[]): string {
  const bad = robots.filter(({ health }) => health?.level === "error");
  const [worst] = bad;
  if (!worst) return "";
  return `${worst.label}: ${worst.health?.summary}${bad.length > 1 ? `, and ${bad.length - 1} more` : ""}`;
}

function connectionTo(robot: RobotSummary, robotsAgeS: number): Connection {
  const { health, label } = robot;
  const isFailing = health?.level === "error";
  if (robot.is_heard && robotsAgeS < TRUSTED_FOR_S) {
    const rules = RULES_WORDS[robot.rules.origin];
    const hasRules = robot.rules.origin !== "fallback";
    const trouble = hasRules && health ? `${sentence(health.message)}.` : "";
    return {
      kind: "connected",
      isFailing,
      words: isFailing ? `${label}: ${health.summary}` : `connected to ${robot.node}`,
      why: `${robot.node} relays ${robot.topics} topics. ${rules}${trouble && ` ${trouble}`}`,
      trouble: hasRules ? trouble : rules,
    };
  }
  const silentS = robot.heard_s_ago + robotsAgeS;
  const words = `silent for ${duration(silentS)}`;
  return {
    kind: silentS < EXPECTED_FOR_S ? "silent" : "none",
    isFailing,
    words: `${label}: ${words}`,
    why: `No status of ${robot.node} for ${duration(silentS)}. Check that 'testudo run' is running and the radio is up.`,
    trouble: "",
  };
}

function none(why: string): Connection {
  return { kind: "none", isFailing: false, words: "not connected", why, trouble: "" };
}

/** Which rules a robot follows, as a sentence. */
export const RULES_WORDS: Record<RulesOrigin, string> = {
  files: "It follows the rule files on its disk.",
  pushed: "It follows rules that were sent to it.",
  waiting: "It is trying rules that were sent to it, and reverts them unless they are kept.",
  fallback: "It has no valid rules. Mend its rule files, or send it rules.",
};

export const RING_LENGTH = 240;

/** The last rates of one topic, in a fixed piece of memory. NaN is "not known". */
export class RateRing {
  private readonly rates_hz = new Float32Array(RING_LENGTH).fill(Number.NaN);
  private next = 0;

  push(rateHz: number | null): void {
    this.rates_hz[this.next] = rateHz ?? Number.NaN;
    this.next = (this.next + 1) % RING_LENGTH;
  }

  /** The rate `age` samples from the oldest one on. */
  at(age: number): number {
    return this.rates_hz[(this.next + age) % RING_LENGTH] ?? Number.NaN;
  }

  /** The largest known rate, at least 1 Hz. */
  highest(): number {
    let highest = 1;
    for (const rate of this.rates_hz) if (rate > highest) highest = rate;
    return highest;
  }
}

/** A ring for each topic that is relayed now. */
class RateRings {
  private readonly rings = new Map<string, RateRing>();

  of(topic: string): RateRing {
    let ring = this.rings.get(topic);
    if (!ring) {
      ring = new RateRing();
      this.rings.set(topic, ring);
    }
    return ring;
  }

  /** Adds one sample to each topic, and forgets topics that are no longer told of. */
  push(topics: Readonly<Record<string, { actual_hz: number | null }>>): void {
    for (const [topic, { actual_hz }] of Object.entries(topics)) this.of(topic).push(actual_hz);
    for (const topic of this.rings.keys()) if (!(topic in topics)) this.rings.delete(topic);
  }

  /** Adds one sample that nobody measured to each topic. */
  pass(): void {
    for (const ring of this.rings.values()) ring.push(null);
  }

  clear(): void {
    this.rings.clear();
  }
}
