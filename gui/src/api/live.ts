// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Push } from "./types";

const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 8000;

/** What the socket calls. */
interface LiveOwner {
  /** A message of the server came; the first is its greeting, after which it can be asked. */
  onPush(push: Push): void;
  /** The server cannot be reached, or knows no token of this browser; it is tried again by itself. */
  onLost(needsToken: boolean): void;
}

/** The web socket to the server; it connects again by itself, ever more seldom up to every 8 s. */
export class LiveSocket {
  private socket: WebSocket | null = null;
  private waitMs = FIRST_WAIT_MS;
  private timer: number | undefined;
  private needsToken = false;

  constructor(private readonly owner: LiveOwner) {}

  open(): void {
    window.clearTimeout(this.timer);
    const socket = new WebSocket(new URL("ws", location.href.replace(/^http/, "ws")));
    this.socket = socket;
    socket.onmessage = ({ data }) => {
      if (this.socket === socket) this.receive(JSON.parse(String(data)) as Push);
    };
    socket.onclose = () => {
      if (this.socket !== socket) return;
      this.socket = null;
      this.owner.onLost(this.needsToken);
      void this.checkToken();
      this.timer = window.setTimeout(() => this.open(), this.waitMs);
      this.waitMs = Math.min(2 * this.waitMs, LONGEST_WAIT_MS);
    };
  }

  /** Tells the server something; lost while there is no connection. */
  send(message: object): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  /** Ends it for good. */
  close(): void {
    window.clearTimeout(this.timer);
    const { socket } = this;
    this.socket = null;
    socket?.close();
  }

  /** A browser does not say why a web socket was refused, but does so of a file. */
  private async checkToken(): Promise<void> {
    const answer = await fetch("./icon.svg", { method: "HEAD", cache: "no-store" }).catch(() => null);
    const needsToken = answer?.status === 401;
    if (needsToken === this.needsToken || this.socket?.readyState === WebSocket.OPEN) return;
    this.needsToken = needsToken;
    this.owner.onLost(needsToken);
  }

  private receive(push: Push): void {
    this.waitMs = FIRST_WAIT_MS;
    this.needsToken = false;
    this.owner.onPush(push);
  }
}
