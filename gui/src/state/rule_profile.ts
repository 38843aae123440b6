// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { signal } from "@preact/signals";
import type { Api, Rules } from "../api/client";
import type { FileAnswer } from "../api/types";
import { diskChangeOf } from "./conflict";

/** The topic parameters that a rule file is checked and optimized with. */
export class RuleProfile {
  readonly used = signal<FileAnswer | null>(null);
  /** Whether it was asked which profile goes with the rules, and no other is being read. */
  readonly isKnown = signal(false);
  /** The profile that was chosen for the rules, where it is no longer there. */
  readonly gone = signal<string | null>(null);
  private wanted: { readonly name: string | null } = { name: null };

  constructor(private readonly api: Api) {}

  /** Uses the profile that was chosen for the rules, else the likeliest; what is chosen meanwhile stays. */
  async recall(rules: Rules): Promise<void> {
    const { wanted } = this;
    this.isKnown.value = false;
    try {
      const { name, gone } = await this.api.profileFor(rules);
      if (this.wanted !== wanted) return;
      await this.use(name, gone);
    } finally {
      if (this.wanted === wanted) this.isKnown.value = true;
    }
  }

  async use(name: string | null, gone: string | null = null): Promise<void> {
    const wanted = { name };
    this.wanted = wanted;
    this.gone.value = gone;
    this.isKnown.value = false;
    try {
      const profile = name === null ? null : await this.api.read(name);
      if (this.wanted === wanted) this.used.value = profile;
    } finally {
      if (this.wanted === wanted) this.isKnown.value = true;
    }
  }

  /** Takes the profile as it is on disk by now, or the one in its place; whether that is another. */
  async lookAtDisk(rules: Rules): Promise<boolean> {
    const used = this.used.value;
    if (used === null) return false;
    const change = await diskChangeOf(this.api, used.name, used.hash);
    if (change === null || used !== this.used.value) return false;
    await (change === "gone" ? this.recall(rules) : this.revive());
    return true;
  }

  /** Reads the profile again. */
  revive(): Promise<void> {
    return this.use(this.wanted.name, this.gone.value);
  }
}
