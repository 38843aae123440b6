// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** The number that somebody typed, with a point or a comma before its decimals; NaN where it is none. */
export function typedNumber(text: string): number {
  return text.trim() === "" ? Number.NaN : Number(text.replace(",", ".").replace("−", "-"));
}

/** A number for reading: three significant digits below 1000, none after the point above. */
export function readable(value: number): string {
  const digits = Math.abs(value) >= 1000 ? { maximumFractionDigits: 0 } : { maximumSignificantDigits: 3 };
  return value.toLocaleString("en", digits).replaceAll(",", " ");
}

/** KB, or KB/s, of the optimizer: at most two decimals, thousands apart, as the terminal shows it. */
export function kilobytes(value: number): string {
  return value.toLocaleString("en", { maximumFractionDigits: 2 }).replaceAll(",", " ");
}

/** A rate for reading; null is every message. */
export function hz(value: number | null): string {
  return value === null ? "Full" : `${readable(value)} Hz`;
}
