// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { signal } from "@preact/signals";
import { type Api, ApiError } from "../api/client";
import type { FetchesAnswer, FetchState, RobotIncidentsAnswer } from "../api/types";

const LOOK_MS = 700;

/** The incidents of the robots on the link, and those that are being fetched, which go on without the page. */
export class RobotIncidents {
  readonly answer = signal<RobotIncidentsAnswer | null>(null);
  readonly fetches = signal<readonly FetchState[]>([]);
  readonly problem = signal("");
  private timer = 0;
  private isOpen = false;

  constructor(
    private readonly api: Api,
    /** Another incident is in the project. */
    private readonly arrived: () => void,
  ) {}

  /** Asks the robots, and follows what is being fetched until the returned function is called. */
  open(): () => void {
    this.isOpen = true;
    void this.ask();
    void this.follow(() => this.api.fetches());
    return () => {
      this.isOpen = false;
      window.clearTimeout(this.timer);
    };
  }

  /** Asks the robots once more. */
  ask(): Promise<void> {
    return this.told(async () => {
      this.answer.value = await this.api.robotIncidents();
    });
  }

  fetch(robot: string, name: string): Promise<void> {
    return this.follow(() => this.api.fetchIncident(robot, name));
  }

  cancel(robot: string, name: string): Promise<void> {
    return this.follow(() => this.api.cancelFetch(robot, name));
  }

  of(robot: string, name: string): FetchState | null {
    return this.fetches.value.find((one) => one.robot === robot && one.name === name) ?? null;
  }

  private async follow(ask: () => Promise<FetchesAnswer>): Promise<void> {
    await this.told(async () => {
      const before = done(this.fetches.peek());
      const { fetches } = await ask();
      this.fetches.value = fetches;
      if (done(fetches) > before) this.arrived();
      window.clearTimeout(this.timer);
      if (this.isOpen && fetches.some(({ state }) => state === "running")) {
        this.timer = window.setTimeout(() => void this.follow(() => this.api.fetches()), LOOK_MS);
      }
    });
  }

  private async told(work: () => Promise<void>): Promise<void> {
    try {
      await work();
      this.problem.value = "";
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      this.problem.value = error.message;
    }
  }
}

function done(fetches: readonly FetchState[]): number {
  return fetches.filter(({ state }) => state === "done").length;
}
