// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { PROTOCOL_VERSION, type Push } from "../../src/api/types";
import type { Answered, Asked, Server } from "./answers";
import { PlayedDrafts } from "./drafts";

/** What the page calls a piece of work, which is another name each time. */
const RUN = /^\d{13} 0\.\d+(?:e-\d+)?/;
const HELLO: Push = { kind: "hello", version: "1.0.0", only_watches: false, protocol: PROTOCOL_VERSION };
const NO_ROBOTS: Push = { kind: "robots", problem: null, robots: [] };
/** The server says so each two seconds that it is there. */
const TOLD_MS = 2000;

const BROWSER = {
  fetch: window.fetch,
  WebSocket: window.WebSocket,
  setTimeout: window.setTimeout,
  setInterval: window.setInterval,
  src: Object.getOwnPropertyDescriptor(HTMLImageElement.prototype, "src") as PropertyDescriptor,
};

/** In place of the browser's `fetch` and web sockets: what `server` answers, and what a test says. */
export class Network {
  /** What the page asked, in its order. */
  readonly asked: Asked[] = [];
  /** What had no answer. */
  readonly complaints: string[] = [];
  /** What each new socket is told. */
  greeting: Push[] = [HELLO, NO_ROBOTS];
  /** What the page told over its sockets. */
  readonly told: unknown[] = [];
  private readonly sockets = new Set<PlayedSocket>();
  private waiting: { route: string; done: () => void }[] = [];
  private readonly held = new Map<string, { words: string; until: Promise<void> }>();
  private readonly replaced = new Map<string, { answer: Answered | "lost"; isFor: (body: unknown) => boolean }>();
  private readonly asking = new Set<Promise<Answered>>();
  private readonly drafts = new PlayedDrafts();
  private isCut = false;
  private isClosed = false;
  /** How many pages it had: one that was left gets no answers, and its timers end. */
  private pages = 0;
  private timers = new Set<number>();
  private timer: number | undefined;

  constructor(private readonly server: Server) {}

  open(): void {
    const network = this;
    window.fetch = (path, init) => this.fetch(String(path), init);
    window.WebSocket = class extends PlayedSocket {
      constructor() {
        super(network);
      }
    } as unknown as typeof WebSocket;
    const { src, setTimeout, setInterval } = BROWSER;
    const noted = (timer: number) => {
      this.timers.add(timer);
      return timer;
    };
    const timed = {
      // What is due at once runs: Blockly tells nobody of anything any more where its own timer of 0 ms is lost.
      setTimeout: (...of: Parameters<typeof setTimeout>) => (of[1] ? noted(setTimeout(...of)) : setTimeout(...of)),
      setInterval: (...of: Parameters<typeof setInterval>) => noted(setInterval(...of)),
    };
    Object.assign(window, timed);
    Object.defineProperty(HTMLImageElement.prototype, "src", {
      ...src,
      set(this: HTMLImageElement, address: string) {
        if (/^(\.?\/)?api\//.test(address)) void network.picture(this, address);
        else src.set?.call(this, address);
      },
    });
    this.timer = setInterval(() => this.tell(this.greeting.at(-1) ?? NO_ROBOTS), TOLD_MS);
  }

  /** The page is left: it hears nothing more, and does nothing more. */
  leavePage(): void {
    this.pages++;
    this.sockets.clear();
    for (const timer of this.timers) window.clearTimeout(timer);
    this.timers.clear();
  }

  /** Nobody is answered any more; waits for what the server still does. */
  async close(): Promise<void> {
    window.clearInterval(this.timer);
    this.isClosed = true;
    this.leavePage();
    const { src, ...browser } = BROWSER;
    // What the page still does after its end asks nobody.
    Object.assign(window, browser, { fetch: () => new Promise(() => {}) });
    Object.defineProperty(HTMLImageElement.prototype, "src", src);
    await Promise.allSettled(this.asking);
  }

  /** Tells all sockets something. */
  tell(push: Push): void {
    for (const socket of this.sockets) socket.hear(push);
  }

  /** How often the page asked something of a route, as `PUT /api/file`. */
  count(route: string): number {
    return this.asked.filter(({ ask }) => ask.split("?")[0] === route).length;
  }

  /** Waits until a route, as `PUT /api/file`, is answered the next time. */
  answered(route: string): Promise<void> {
    return new Promise((done) => this.waiting.push({ route, done }));
  }

  /**
   * Keeps answers of a route, as `POST /api/optimize`, until the returned function is called; with `words` only
   * those whose request holds them.
   */
  hold(route: string, words = ""): () => void {
    let release = () => {};
    const until = new Promise<void>((done) => {
      release = () => {
        this.held.delete(route);
        done();
      };
    });
    this.held.set(route, { words, until });
    return () => release();
  }

  /** Answers a route otherwise from now on, or loses it, where `isFor` takes what was sent; null as recorded. */
  replace(route: string, answer: Answered | "lost" | null, isFor: (body: unknown) => boolean = () => true): void {
    if (answer === null) this.replaced.delete(route);
    else this.replaced.set(route, { answer, isFor });
  }

  /** The server ends, or comes back. */
  cut(isCut: boolean): void {
    this.isCut = isCut;
    if (!isCut) return;
    for (const socket of [...this.sockets]) socket.close();
  }

  greet(socket: PlayedSocket): void {
    if (this.isCut || this.isClosed) socket.close();
    if (socket.readyState !== PlayedSocket.CONNECTING) return;
    this.sockets.add(socket);
    socket.open();
    for (const push of this.greeting) socket.hear(push);
  }

  leave(socket: PlayedSocket): void {
    this.sockets.delete(socket);
  }

  private async fetch(path: string, init: RequestInit = {}): Promise<Response> {
    if (path.startsWith("data:") || path.startsWith("blob:")) return BROWSER.fetch(path, init);
    const ask = `${init.method ?? "GET"} ${path.replace(/^\.?\/?/, "/")}`;
    const body = await sent(init.body);
    this.asked.push({ ask, body });
    return Promise.race([this.answer({ ask, body }), aborted(init.signal)]);
  }

  /** Never of a page that was left meanwhile. */
  private async answer(asked: Asked): Promise<Response> {
    const { pages } = this;
    const answer = await this.answerOf(asked);
    return pages === this.pages ? answer : new Promise(() => {});
  }

  private async answerOf(asked: Asked): Promise<Response> {
    const route = asked.ask.split("?")[0] as string;
    // As over a network: not in the same turn.
    await new Promise((done) => BROWSER.setTimeout.call(window, done));
    const held = this.held.get(route);
    if (held !== undefined && JSON.stringify(asked).includes(held.words)) await held.until;
    if (this.isClosed) return new Promise(() => {});
    const replaced = this.replaced.get(route);
    const otherwise = replaced?.isFor(asked.body) ? replaced.answer : null;
    if (this.isCut || otherwise === "lost") throw new TypeError("Failed to fetch");
    if (!route.includes(" /api/")) return new Response();
    try {
      const answer = otherwise ?? this.drafts.answer(asked) ?? (await this.ask(asked));
      if (route === "PUT /api/file" && answer.status === 200) this.drafts.saved((asked.body as { name: string }).name);
      for (const one of this.waiting) if (one.route === route) one.done();
      this.waiting = this.waiting.filter((one) => one.route !== route);
      return responseOf(answer);
    } catch (error) {
      this.complaints.push(String(error));
      throw error;
    }
  }

  private async ask(asked: Asked): Promise<Answered> {
    const asking = this.server.answer(asked);
    this.asking.add(asking);
    try {
      return await asking;
    } finally {
      this.asking.delete(asking);
    }
  }

  private async picture(image: HTMLImageElement, address: string): Promise<void> {
    const picture = await (await this.fetch(address)).blob();
    image.src = URL.createObjectURL(picture);
  }
}

/** A socket of the page, which the network greets in the next turn. */
class PlayedSocket {
  static readonly CONNECTING = 0;
  static readonly OPEN = 1;
  static readonly CLOSED = 3;
  readyState: number = PlayedSocket.CONNECTING;
  onopen: (() => void) | null = null;
  onmessage: ((message: { data: string }) => void) | null = null;
  onclose: (() => void) | null = null;

  constructor(private readonly network: Network) {
    setTimeout(() => network.greet(this));
  }

  open(): void {
    this.readyState = PlayedSocket.OPEN;
    this.onopen?.();
  }

  hear(push: Push): void {
    if (this.readyState === PlayedSocket.OPEN) this.onmessage?.({ data: JSON.stringify(push) });
  }

  send(text: string): void {
    this.network.told.push(JSON.parse(text));
  }

  close(): void {
    if (this.readyState === PlayedSocket.CLOSED) return;
    this.readyState = PlayedSocket.CLOSED;
    this.network.leave(this);
    setTimeout(() => this.onclose?.());
  }
}

async function sent(body: RequestInit["body"]): Promise<unknown> {
  if (body === undefined || body === null) return null;
  if (typeof body === "string") return steady(JSON.parse(body));
  const bytes = new Uint8Array(await new Response(body).arrayBuffer());
  return { base64: btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join("")) };
}

function steady(body: Record<string, unknown> | null): unknown {
  // What a draft is called is another each time.
  const { draft_ids: _, ...kept } = body ?? {};
  const { run } = kept;
  return typeof run === "string" ? { ...kept, run: run.replace(RUN, "run") } : body && kept;
}

function responseOf({ status, json, type, base64 }: Answered): Response {
  if (base64 === undefined) return Response.json(json, { status });
  const bytes = Uint8Array.from(atob(base64), (char) => char.charCodeAt(0));
  return new Response(bytes, { status, headers: { "Content-Type": type ?? "" } });
}

function aborted(signal: AbortSignal | null | undefined): Promise<never> {
  return new Promise((_, fail) => {
    if (signal?.aborted) fail(signal.reason);
    signal?.addEventListener("abort", () => fail(signal.reason));
  });
}
