// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { signal } from "@preact/signals";
import { type Api, refusalOf } from "../api/client";
import type { FetchesAnswer, FetchState, RobotIncidentsAnswer } from "../api/types";

const FOLLOW_MS = 700;
const LOOK_MS = 2000;

/** The incidents of the robots on the link, and those that are being fetched, which go on without the page. */
export class RobotIncidents {
  /** What each robot answered last, also one that left since. */
  readonly answer = signal<RobotIncidentsAnswer | null>(null);
  readonly heard = signal<readonly string[]>([]);
  readonly fetches = signal<readonly FetchState[]>([]);
  readonly problem = signal("");
  private timer = 0;
  private isOpen = false;
  private isAsking = false;

  constructor(
    private readonly api: Api,
    /** Another incident is in the project. */
    private readonly arrived: () => void,
  ) {}

  /** Asks the robots, those that come later too, and follows what is fetched until the returned function is called. */
  open(): () => void {
    this.isOpen = true;
    void this.ask();
    void this.follow(() => this.api.ask("GET /api/robot-incidents/fetches", null));
    return () => {
      this.isOpen = false;
      window.clearTimeout(this.timer);
    };
  }

  /** Asks the robots once more. */
  async ask(): Promise<void> {
    this.isAsking = true;
    await this.told(async () => {
      const answer = await this.api.ask("GET /api/robot-incidents", null);
      const heard = answer.robots.map(({ robot }) => robot);
      const before = this.answer.peek()?.robots ?? [];
      const left = before.filter(({ robot, incidents }) => incidents.length > 0 && !heard.includes(robot));
      this.heard.value = heard;
      this.answer.value = { ...answer, robots: [...answer.robots, ...left] };
    });
    this.isAsking = false;
  }

  fetch(robot: string, name: string): Promise<void> {
    return this.follow(() => this.api.ask("POST /api/robot-incidents/fetch", { robot, name }));
  }

  cancel(robot: string, name: string): Promise<void> {
    return this.follow(() => this.api.ask("POST /api/robot-incidents/cancel", { robot, name }));
  }

  of(robot: string, name: string): FetchState | null {
    return this.fetches.value.find((one) => one.robot === robot && one.name === name) ?? null;
  }

  private async follow(ask: () => Promise<FetchesAnswer>): Promise<void> {
    await this.told(async () => {
      const before = done(this.fetches.peek());
      const { fetches, heard } = await ask();
      this.fetches.value = fetches;
      if (done(fetches) > before) this.arrived();
      this.hear(heard);
    });
    window.clearTimeout(this.timer);
    if (!this.isOpen || this.answer.peek()?.is_linked === false) return;
    const isRunning = this.fetches.peek().some(({ state }) => state === "running");
    this.timer = window.setTimeout(
      () => void this.follow(() => this.api.ask("GET /api/robot-incidents/fetches", null)),
      isRunning ? FOLLOW_MS : LOOK_MS,
    );
  }

  /** Asks again where a robot came, or none could be asked: each question costs the link. */
  private hear(heard: readonly string[]): void {
    if (this.isAsking) return;
    const isNew = heard.some((robot) => !this.heard.peek().includes(robot));
    this.heard.value = heard;
    if (isNew || this.answer.peek()?.problem !== "") void this.ask();
  }

  private async told(work: () => Promise<void>): Promise<void> {
    this.problem.value = await refusalOf(work);
  }
}

function done(fetches: readonly FetchState[]): number {
  return fetches.filter(({ state }) => state === "done").length;
}
