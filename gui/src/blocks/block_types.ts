// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { RuleStatement } from "../api/types";
import { ACTION, appendAdders, defineActionBlocks, type PartAdders } from "./action_blocks";
import { CLOCK_METHODS, chooseTime } from "./clocks";
import {
  button,
  CLOCK,
  CONDITION,
  COPY,
  chain,
  comparedField,
  MINUS,
  OPEN,
  operatorField,
  PLUS,
  priorityField,
  propertyField,
  quietButton,
  quietWords,
  SHUT,
  type Suggestions,
  SWITCH,
  textField,
  topicField,
} from "./fields";
import { defineInside } from "./inside_block";
import { FOLDED, type FoldedRule, type RuleBlock } from "./model";
import { ruleName, ruleSets } from "./rule_words";

/** What the small buttons on blocks do. */
export interface BlockButtons extends PartAdders {
  addCheck(block: Blockly.BlockSvg): void;
  toggleElse(block: Blockly.BlockSvg): void;
  remove(block: Blockly.BlockSvg): void;
  /** Folds a rule to one line, or unfolds it. */
  toggleFold(block: Blockly.BlockSvg): void;
  /** Does something with a whole rule, in the text. */
  act(block: Blockly.BlockSvg, act: RuleAct): void;
  /** Lets somebody draw the zone of a block on the map. */
  drawZone(block: Blockly.BlockSvg): void;
}

/** What is done with a whole rule. */
export type RuleAct = "switch" | "duplicate" | "up" | "down";

/** What a rule block keeps beside its fields. */
interface RuleBlockState {
  hasElse?: boolean;
  isOff?: boolean;
}

const SWITCH_OFF = "Switch this rule off";
const SWITCH_ON = "Switch this rule on";
const OFF_WORDS = "⊘ switched off";
const LONGEST_RAW_LINES = 8;

type Init = (this: Blockly.BlockSvg) => void;

/** Defines every block of the language, once for a page. */
export function defineBlocks(suggest: Suggestions, buttons: BlockButtons): void {
  const removeButton = (label: string) => quietButton(MINUS, label, (block) => buttons.remove(block));
  const init = (type: string, define: Init, more: object = {}) => {
    Blockly.Blocks[type] = { init: define, ...more };
  };

  const addElse = (block: Blockly.BlockSvg) => buttons.toggleElse(block);
  const appendElseButton = (rule: Blockly.BlockSvg) =>
    rule
      .appendDummyInput("TAIL")
      .appendField(quietWords("else"))
      .appendField(quietButton(PLUS, "Add ELSE", addElse), "ADD_ELSE");

  defineActionBlocks(suggest, buttons.remove);
  defineFolded(buttons.toggleFold);
  defineInside(suggest, buttons);

  init(
    "adirf_check",
    function () {
      this.appendDummyInput()
        .appendField("", "JOIN")
        .appendField(
          topicField(suggest, "topic to check", () => suggest.vitalsChoices()),
          "TOPIC",
        )
        .appendField(
          propertyField("pose_x", (topic) => suggest.properties(topic)),
          "PROPERTY",
        )
        .appendField(operatorField(), "OP")
        .appendField(comparedField(suggest), "VALUE")
        .appendField(new Blockly.FieldLabel(""), "UNIT")
        .appendField(quietButton(CLOCK, "Add time", chooseTime), "CLOCK")
        .appendField(removeButton("Remove this check"));
      chain(this, CONDITION, "check");
      this.setTooltip(
        "Compares a property of the newest message of the topic with a number, a text, true, false or a constant.",
      );
    },
    CLOCK_METHODS,
  );

  for (const [type, label, tooltip] of [
    ["adirf_all", "all of", "Holds while all checks inside hold."],
    ["adirf_any", "any of", "Holds while at least one check inside holds."],
    ["adirf_not", "not", "Holds while the checks inside do not all hold."],
  ] as const) {
    init(
      type,
      function () {
        this.appendDummyInput()
          .appendField("", "JOIN")
          .appendField(label)
          .appendField(button(PLUS, "Add check", (block) => buttons.addCheck(block)))
          .appendField(quietButton(CLOCK, "Add time", chooseTime), "CLOCK")
          .appendField(removeButton(`Remove this ${label}`));
        this.appendStatementInput("TERMS").setCheck(CONDITION);
        chain(this, CONDITION, "check");
        this.setTooltip(tooltip);
      },
      CLOCK_METHODS,
    );
  }

  init(
    "adirf_rule",
    function () {
      this.appendDummyInput()
        .appendField(button(SHUT, "Fold this rule", buttons.toggleFold), "FOLD")
        .appendField("rule")
        .appendField(textField("", "name of the rule", "name this rule"), "NAME")
        .appendField(priorityField(), "PRIORITY")
        .appendField(
          quietButton(SWITCH, SWITCH_OFF, (block) => buttons.act(block, "switch")),
          "SWITCH",
        )
        .appendField(quietButton(COPY, "Duplicate this rule", (block) => buttons.act(block, "duplicate")))
        .appendField(removeButton("Remove this rule"));
      this.appendDummyInput()
        .appendField("IF")
        .appendField(button(PLUS, "Add check", (block) => buttons.addCheck(block)));
      this.appendStatementInput("IF").setCheck(CONDITION);
      appendAdders(this.appendDummyInput().appendField("THEN"), "THEN", "", buttons);
      this.appendStatementInput("THEN").setCheck(ACTION);
      appendElseButton(this);
      this.setStyle("rule");
      this.setTooltip("While the condition holds, the rates under THEN are in force.");
    },
    {
      setElse(this: Blockly.BlockSvg, shown: boolean) {
        if (shown === (this.getInput("ELSE") !== null)) return;
        this.removeInput(shown ? "TAIL" : "ELSE");
        if (!shown) this.removeInput("ELSE_HEAD");
        if (shown) {
          const head = this.appendDummyInput("ELSE_HEAD").appendField("ELSE");
          appendAdders(head, "ELSE", " to ELSE", buttons);
          head.appendField(quietButton(MINUS, "Remove ELSE", (block) => buttons.toggleElse(block)));
          this.appendStatementInput("ELSE").setCheck(ACTION);
        } else {
          appendElseButton(this);
        }
      },
      isSwitchedOff(this: Blockly.BlockSvg) {
        return this.getInput("OFF") !== null;
      },
      switchOff(this: RuleBlock, isOff: boolean) {
        if (isOff === this.isSwitchedOff()) return;
        if (isOff) {
          this.appendDummyInput("OFF").appendField(OFF_WORDS);
          this.moveNumberedInputBefore(this.inputList.length - 1, 0);
        } else this.removeInput("OFF");
        this.getField("SWITCH")?.setValue(SWITCH);
        (this.getField("SWITCH") as Blockly.FieldImage).setAlt(isOff ? SWITCH_ON : SWITCH_OFF);
        this.setStyle(isOff ? "raw" : "rule");
        // What is in it keeps its own colours, and looks grey, too.
        if (this.rendered !== undefined && this.getSvgRoot) {
          this.getSvgRoot().classList.toggle("switched-off", isOff);
        }
      },
      saveExtraState(this: RuleBlock): RuleBlockState | null {
        const state = {
          ...(this.getInput("ELSE") ? { hasElse: true } : {}),
          ...(this.isSwitchedOff() ? { isOff: true } : {}),
        };
        return Object.keys(state).length > 0 ? state : null;
      },
      loadExtraState(this: RuleBlock, state: RuleBlockState) {
        this.setElse(state.hasElse === true);
        this.switchOff(state.isOff === true);
      },
    },
  );

  init("adirf_raw", function () {
    this.appendDummyInput("LINES").appendField("as text");
    this.setStyle("raw");
    this.setEditable(false);
    this.setTooltip("Blocks cannot show this part. Change it in the text.");
  });
}

/** Fills a raw block with the first lines of its text. */
export function showRawText(block: Blockly.Block, text: string): void {
  const lines = text.split(/\r?\n/);
  const shown = lines.length > LONGEST_RAW_LINES ? [...lines.slice(0, LONGEST_RAW_LINES), "…"] : lines;
  for (const line of shown) block.appendDummyInput().appendField(line.replaceAll("\t", "  ") || " ");
}

interface FoldedState {
  rule: RuleStatement;
}

const MOST_LETTERS = 56;

function defineFolded(unfold: (block: Blockly.BlockSvg) => void): void {
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
