// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

const BLANK_BETWEEN_THOUSANDS = /(?<=\d)[ \u00a0\u2009\u202f](?=\d{3}(?!\d))/g;
/** A comma before exactly three digits stands before decimals for some people and between thousands for others. */
const COMMA_OF_TWO_MEANINGS = /^[+-]?[1-9]\d{0,2},\d{3}$/;
/** A point with two meanings, where people write decimals with a comma. No number that the page shows ends so. */
const POINT_OF_TWO_MEANINGS = /^[+-]?[1-9]\d{0,2}\.\d{2}0$/;

/** Whether the browser's language writes decimals with a comma. The first answer takes long. */
const writesComma = () => new Intl.NumberFormat().format(0.5).includes(",");

/** The number that somebody typed, with a point or a comma before its decimals; NaN where it is none, or could be two. */
export function typedNumber(text: string, hasComma?: boolean): number {
  const plain = plainText(text);
  return plain === "" || hasTwoMeanings(plain, hasComma) ? Number.NaN : Number(plain.replace(",", "."));
}

/** Why a text is not one number, in words; empty where it is one. */
export function numberProblem(text: string, hasComma?: boolean): string {
  const typed = typedNumber(text, hasComma);
  if (Math.abs(typed) === Infinity) return `“${text.trim()}” is too large a number`;
  if (!Number.isNaN(typed)) return "";
  const plain = plainText(text);
  if (plain === "") return "A number is needed here";
  const said = `“${text.trim()}”`;
  if (hasTwoMeanings(plain, hasComma)) {
    const [decimals, thousands] = [Number(plain.replace(",", ".")), Number(plain.replace(/[.,]/, ""))];
    return `${said} can mean ${decimals} or ${thousands}: write ${decimals} or ${thousands}`;
  }
  const decimal = Math.max(plain.lastIndexOf("."), plain.lastIndexOf(","));
  const meant = plain.slice(0, Math.max(decimal, 0)).replace(/[.,]/g, "") + plain.slice(decimal).replace(",", ".");
  const isMeant = decimal >= 0 && Number.isFinite(Number(meant));
  return isMeant ? `${said} has thousands marked: write ${Number(meant)}` : `${said} is not a number`;
}

/** Why a text is none of some words, nor one number: what is wrong with its digits, or else `otherwise`. */
export function numberProblemOr(text: string, otherwise: string): string {
  return (/\d/.test(text) && numberProblem(text)) || otherwise;
}

function plainText(text: string): string {
  return text.trim().replace("−", "-").replace(BLANK_BETWEEN_THOUSANDS, "");
}

function hasTwoMeanings(plain: string, hasComma?: boolean): boolean {
  return COMMA_OF_TWO_MEANINGS.test(plain) || (POINT_OF_TWO_MEANINGS.test(plain) && (hasComma ?? writesComma()));
}

/** A number for reading: three significant digits below 1000, none after the point above. */
export function readable(value: number): string {
  const digits = Math.abs(value) >= 1000 ? { maximumFractionDigits: 0 } : { maximumSignificantDigits: 3 };
  return thousandsApart(value, digits);
}

const LONGEST_TEXT = 24;

/** A value that a check reads; a long text is cut. */
export function valueText(value: number | string): string {
  if (typeof value === "number") return readable(value);
  return `“${value.length > LONGEST_TEXT ? `${value.slice(0, LONGEST_TEXT - 1)}…` : value}”`;
}

/** KB, or KB/s, of the optimizer: at most two decimals, thousands apart, as the terminal shows it. */
export function kilobytes(value: number): string {
  return thousandsApart(value, { maximumFractionDigits: 2 });
}

/** A number in a column: so many decimals, thousands apart, a true minus, as the terminal's tables show it. */
export function fixed(value: number, decimals: number): string {
  const digits = { minimumFractionDigits: decimals, maximumFractionDigits: decimals };
  return thousandsApart(value, { ...digits, signDisplay: "negative" }).replace("-", "−");
}

const MOST_PERCENT_DECIMALS = 6;

/** Percent, with the decimals that it takes to read as 0 or 100 only where it is that. */
export function percent(value: number, decimals = 1): string {
  let enough = decimals;
  while (enough < MOST_PERCENT_DECIMALS && [0, 100].includes(Math.abs(Number(value.toFixed(enough))))) enough += 1;
  return fixed(value, [0, 100].includes(Math.abs(Number(value.toFixed(enough)))) ? decimals : enough);
}

function thousandsApart(value: number, digits: Intl.NumberFormatOptions): string {
  return value.toLocaleString("en", digits).replaceAll(",", " ");
}

/** A rate for reading; null is every message. */
export function hz(value: number | null): string {
  return value === null ? "Full" : `${readable(value)} Hz`;
}

/** KB as what a person calls it. */
export function sizeWords(kb: number): string {
  if (kb < 1) return `${readable(1000 * kb)} B`;
  if (kb < 1000) return `${readable(kb)} KB`;
  return kb < 1_000_000 ? `${readable(kb / 1000)} MB` : `${readable(kb / 1_000_000)} GB`;
}

/** `1 message`, `1 200 messages`. */
export function counted(count: number, noun: string): string {
  return `${readable(count)} ${noun}${count === 1 ? "" : "s"}`;
}

const MINUTES_FROM_S = 120;

/** A duration for reading: seconds below two minutes, minutes from there on. */
export function durationWords(seconds: number): string {
  return seconds < MINUTES_FROM_S ? `${readable(seconds)} s` : `${readable(seconds / 60)} min`;
}

/** A message of the server as a sentence: a capital first, unless the first word is a name, as in `pose_y is …`. */
export function sentence(text: string): string {
  return /^[a-z]+(?=[\s,:;]|$)/.test(text) ? text.charAt(0).toUpperCase() + text.slice(1) : text;
}

const MOMENT = { dateStyle: "medium", timeStyle: "medium" } as const;
export const NS_PER_MS = 1_000_000;
const DAY_MS = 86_400_000;

/** A time since 1970 as day, hour, minute and second where the reader is. */
export function moment(ms: number): string {
  return new Date(ms).toLocaleString("en-GB", MOMENT);
}

/** A time since 1970 as hour and minute where the reader is. */
export function clock(ms: number, timeStyle: "short" | "medium" = "short"): string {
  return new Date(ms).toLocaleTimeString("en-GB", { timeStyle });
}

/** How long ago something was, in the words of a list: `just now`, `5 minutes ago`, `yesterday`, `3 Mar 2026`. */
export function ago(ms: number, nowMs: number): string {
  const minutes = Math.floor((nowMs - ms) / 60_000);
  if (minutes < 1) return "just now";
  if (minutes < 60) return `${counted(minutes, "minute")} ago`;
  if (minutes < 24 * 60) return `${counted(Math.floor(minutes / 60), "hour")} ago`;
  const days = Math.floor((nowMs - ms) / DAY_MS);
  if (days < 14) return days === 1 ? "yesterday" : `${counted(days, "day")} ago`;
  return new Date(ms).toLocaleDateString("en-GB", { dateStyle: "medium" });
}
