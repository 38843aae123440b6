// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { signal } from "@preact/signals";
import type { Api, Rules } from "../api/client";

/** The topic parameters that a rule file is checked and optimized with. */
export class RuleProfile {
  readonly used = signal<{ name: string; text: string } | null>(null);
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

  /** Reads the profile again. */
  revive(): Promise<void> {
    return this.use(this.wanted.name, this.gone.value);
  }
}
