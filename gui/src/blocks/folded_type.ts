// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { RuleStatement } from "../api/types";
import { button, OPEN } from "./fields";
import { FOLDED, type FoldedRule } from "./model";
import { ruleName, ruleSets } from "./rule_words";

interface FoldedState {
  rule: RuleStatement;
}

const MOST_LETTERS = 56;

export function defineFolded(unfold: (block: Blockly.BlockSvg) => void): void {
  Blockly.Blocks[FOLDED] = {
    init(this: FoldedRule) {
      this.appendDummyInput("LINE").appendField(button(OPEN, "Unfold this rule", unfold), "FOLD");
      this.setStyle("rule");
      this.setTooltip("A rule, folded to one line. Unfold it to change it.");
    },
    isSwitchedOff(this: FoldedRule) {
      return this.rule.is_disabled === true;
    },
    saveExtraState(this: FoldedRule): FoldedState {
      return { rule: this.rule };
    },
    loadExtraState(this: Blockly.BlockSvg & { rule: RuleStatement }, { rule }: FoldedState) {
      this.rule = rule;
      const isOff = rule.is_disabled === true;
      const line = this.getInput("LINE");
      (this.getField("FOLD") as Blockly.FieldImage).setAlt(`Unfold ${ruleName(rule)}`);
      line?.appendField(new Blockly.FieldLabel(ruleName(rule), "folded-name"));
      line?.appendField(`${isOff ? "⊘ switched off" : "sets"} ${ruleSets(rule, MOST_LETTERS)}`);
      if (isOff) this.setStyle("raw");
    },
  };
}
