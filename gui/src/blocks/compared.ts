// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Compared } from "../api/types";
import { numberProblem, numberProblemOr, typedNumber } from "../ui/numbers";

const TEXT = /^"(?:[^"\\\r\n]|\\["\\])*"$/;
const TRUTH = /^(?:true|false)$/i;
const CONSTANT = /^(?:[A-Za-z]\w*(?:\/\w+)*\.)?[A-Z](?:_?[A-Z0-9])*$/;
const LIKE_NUMBER = /^[+\-−]?[.,]?\d/;

/** A text as a rule file writes it. */
export function quoted(text: string): string {
  return `"${text.replace(/["\\]/g, "\\$&")}"`;
}

/** The words of a text that is written in quotes. */
export function unquoted(text: string): string {
  return text.slice(1, -1).replace(/\\(["\\])/g, "$1");
}

/** What somebody typed to compare with: other words than a constant are a text; null where it is nothing. */
export function parseCompared(typed: string): Compared | null {
  const text = typed.trim();
  const number = typedNumber(text);
  if (Number.isFinite(number)) return number;
  if (TRUTH.test(text)) return text.toLowerCase();
  if (TEXT.test(text) || CONSTANT.test(text)) return text;
  return text === "" || text.startsWith('"') || LIKE_NUMBER.test(text) ? null : quoted(text);
}

/** Whether a text means itself as it is typed, so that nothing is to be put around it. */
export function isWholeCompared(typed: string): boolean {
  const text = typed.trim();
  return TEXT.test(text) || CONSTANT.test(text) || TRUTH.test(text) || Number.isFinite(typedNumber(text));
}

/** Why a text is nothing to compare with, in words; empty where it is something. */
export function comparedProblem(typed: string): string {
  if (parseCompared(typed) !== null) return "";
  const otherwise = "Compared is with a number, a text, true, false or a constant";
  return LIKE_NUMBER.test(typed.trim()) ? numberProblem(typed) : numberProblemOr(typed, otherwise);
}

/** Whether two sides can only be equal or not. */
export function isOfEquality(value: Compared): boolean {
  return typeof value === "string" && (TEXT.test(value) || TRUTH.test(value));
}

/** What a field that compares holds, as statements have it. */
export function comparedIn(value: unknown): Compared {
  return parseCompared(String(value)) ?? 0;
}

/** What somebody typed as the value of a parameter, whose digits stay: 1 is no 1.0; null where it is nothing. */
export function parseParameter(typed: string): string | null {
  const text = typed.trim();
  if (/^[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?$/.test(text)) return text;
  const value = CONSTANT.test(text) && !TRUTH.test(text) ? quoted(text) : parseCompared(text);
  return value === null ? null : String(value);
}
