// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** What plugin.mjs makes of the chapters. */
declare module "virtual:documentation" {
  export const CHAPTERS: readonly { anchor: string; title: string; html: string }[];
}
