// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import "vitest/browser";

declare module "vitest/browser" {
  interface LocatorSelectors {
    /** What a CSS selector finds. */
    getByCss: (selector: string) => Locator;
  }

  /** Those of commands.mjs. */
  interface BrowserCommands {
    recordedAnswers: (file: string) => Promise<string | null>;
    isRecording: () => Promise<boolean>;
    recorder: (act: string, said: object) => Promise<unknown>;
    askServer: (ask: string, body: unknown) => Promise<{ status: number; json: unknown }>;
    resize: (width: number, height: number) => Promise<boolean>;
    emulateMotion: (motion: "reduce" | "no-preference") => Promise<void>;
    colorScheme: (scheme: "light" | "dark") => Promise<void>;
    isBrief: () => Promise<boolean>;
    press: (...keys: string[]) => Promise<void>;
    type: (text: string) => Promise<void>;
    insertText: (text: string) => Promise<void>;
    keyDown: (key: string) => Promise<void>;
    keyUp: (key: string) => Promise<void>;
    mouseMove: (x: number, y: number, steps?: number) => Promise<void>;
    mouseDown: (button?: "left" | "right" | "middle") => Promise<void>;
    mouseUp: (button?: "left" | "right" | "middle") => Promise<void>;
    mouseWheel: (x: number, y: number) => Promise<void>;
    tap: (x: number, y: number) => Promise<void>;
    nextDownload: () => Promise<{ name: string; text: string }>;
  }
}
