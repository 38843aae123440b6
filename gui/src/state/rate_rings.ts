// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

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

/** One ring for each topic that is relayed now. */
export class RateRings {
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
