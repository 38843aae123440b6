// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

// The colours of the style sheet for what is drawn on a canvas; they differ between light and dark.

const darkness = matchMedia("(prefers-color-scheme: dark)");

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

// That of a rule, by the class that its drawings have.
function ruleColour(cssClass) {
  return colour(`--${cssClass.replace("by-", "")}`);
}

function faded(hex, share) {
  return hex + Math.round(share * 255).toString(16).padStart(2, "0");
}

const FONT = '11px system-ui, "Segoe UI", Roboto, "Helvetica Neue", "Noto Sans", "DejaVu Sans", sans-serif';
