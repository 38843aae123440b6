// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";

/** At the scale of blocks it is 13 px. */
const FONT_PT = 13.6;
const BLOCK_STYLES = {
  rate: { colourPrimary: "#2b6cb0", colourSecondary: "#dbe9f8", colourTertiary: "#1e4f85" },
  floor: { colourPrimary: "#6b4fa3", colourSecondary: "#e7def7", colourTertiary: "#4c3679" },
  rule: { colourPrimary: "#a2590c", colourSecondary: "#f7e5cf", colourTertiary: "#7a4207" },
  check: { colourPrimary: "#1f7a55", colourSecondary: "#d3efe3", colourTertiary: "#14573c" },
  record: { colourPrimary: "#9b2c55", colourSecondary: "#f9dde7", colourTertiary: "#6f1d3b" },
  raw: { colourPrimary: "#5b6472", colourSecondary: "#e3e6ea", colourTertiary: "#434b57" },
};

/** Blockly's theme in the page's own colours, read from its style sheet. */
export function blocklyTheme(root: HTMLElement): Blockly.Theme {
  const colours = getComputedStyle(root);
  const colour = (name: string) => colours.getPropertyValue(name).trim();
  // The name becomes a class of the page's style sheet.
  const name = `ruler-${colour("--canvas").replace("#", "")}`;
  return Blockly.Theme.defineTheme(name, {
    name,
    base: "zelos",
    blockStyles: BLOCK_STYLES as unknown as Record<string, Blockly.Theme.BlockStyle>,
    categoryStyles: {
      rate: { colour: BLOCK_STYLES.rate.colourPrimary },
      rule: { colour: BLOCK_STYLES.rule.colourPrimary },
      check: { colour: BLOCK_STYLES.check.colourPrimary },
      floor: { colour: BLOCK_STYLES.floor.colourPrimary },
      record: { colour: BLOCK_STYLES.record.colourPrimary },
    },
    componentStyles: {
      workspaceBackgroundColour: colour("--canvas"),
      toolboxBackgroundColour: colour("--surface"),
      toolboxForegroundColour: colour("--text"),
      flyoutBackgroundColour: colour("--surface-2"),
      flyoutForegroundColour: colour("--text"),
      flyoutOpacity: 1,
      scrollbarColour: colour("--line-strong"),
      scrollbarOpacity: 0.6,
      selectedGlowColour: colour("--accent"),
    },
    fontStyle: { family: colour("--font"), weight: "500", size: FONT_PT },
  });
}
