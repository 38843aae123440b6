// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { Operator } from "../api/types";
import { NumberField } from "./number_field";
import { parseRate, RATE_WORDS, rateText } from "./rate_text";
import { oneWord, type Suggestion, SuggestionField } from "./suggestion_field";

/** What the blocks suggest. */
export interface Suggestions {
  topics(): readonly string[];
  /** Topics with a word on where they come from, such as a live robot. */
  markedTopics(): readonly Suggestion[];
  properties(topic: string): readonly string[];
  unit(topic: string, property: string): string;
}
/** What the small buttons on blocks do. */
export interface BlockButtons {
  addCheck(block: Blockly.BlockSvg): void;
  addRate(block: Blockly.BlockSvg, input: string): void;
  toggleElse(block: Blockly.BlockSvg): void;
  remove(block: Blockly.BlockSvg): void;
}

/** A rule block grows an ELSE part when asked. */
export interface RuleBlock extends Blockly.BlockSvg {
  setElse(shown: boolean): void;
}

export const CONDITION = "Condition";
export const ACTION = "Action";
const OPERATORS: [string, Operator][] = [
  [">", ">"],
  ["<", "<"],
  ["≥", ">="],
  ["≤", "<="],
  ["=", "="],
  ["≠", "!="],
];
const LONGEST_RAW_LINES = 8;

const icon = (path: string) =>
  `data:image/svg+xml,${encodeURIComponent(
    `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 24 24"><circle cx="12" cy="12" r="11" fill="#fff" fill-opacity=".22"/><path d="${path}" stroke="#fff" stroke-width="2.4" stroke-linecap="round"/></svg>`,
  )}`;
const PLUS = icon("M12 7v10M7 12h10");
const MINUS = icon("M7 12h10");

type Init = (this: Blockly.BlockSvg) => void;

/** Defines every block of the language, once for a page. */
export function defineBlocks(suggest: Suggestions, buttons: BlockButtons): void {
  const topicField = (label: string) =>
    new SuggestionField("/odom", () => suggest.markedTopics(), label, oneWord as Blockly.FieldTextInputValidator);
  const button = (src: string, label: string, act: (block: Blockly.BlockSvg) => void) =>
    new Blockly.FieldImage(src, 22, 22, label, (field) => act(field.getSourceBlock() as Blockly.BlockSvg));
  const removeButton = (label: string) => button(MINUS, label, (block) => buttons.remove(block));
  const init = (type: string, define: Init, more: object = {}) => {
    Blockly.Blocks[type] = { init: define, ...more };
  };

  init("adirf_set", function () {
    const unit = new Blockly.FieldLabel("Hz");
    const rate = new SuggestionField(
      "10",
      () => RATE_WORDS,
      "rate",
      (text) => {
        const parsed = parseRate(text);
        unit.setValue(parsed?.kind === "hz" ? "Hz" : "");
        return parsed === null ? null : rateText(parsed);
      },
    );
    this.appendDummyInput()
      .appendField("set frequency of")
      .appendField(topicField("topic to send"), "TOPIC")
      .appendField("to")
      .appendField(rate, "RATE")
      .appendField(unit, "UNIT")
      .appendField(removeButton("Remove this rate"));
    chain(this, ACTION, "rate");
    this.setTooltip("Relays the topic at this rate. Inside a rule: while the rule's condition holds.");
  });

  init("adirf_keep", function () {
    this.appendDummyInput()
      .appendField("keep")
      .appendField(topicField("topic to keep"), "TOPIC")
      .appendField("at least at")
      .appendField(numberField("1", "floor in Hz", 0), "HZ")
      .appendField("Hz")
      .appendField(removeButton("Remove this floor"));
    this.setStyle("floor");
    this.setTooltip("A floor: no rule and no optimizer goes below it.");
  });

  init("adirf_check", function () {
    const unit = new Blockly.FieldLabel("");
    const property = new SuggestionField(
      "pose_x",
      () => suggest.properties(String(this.getFieldValue("TOPIC"))),
      "property",
      oneWord as Blockly.FieldTextInputValidator,
    );
    this.appendDummyInput()
      .appendField("", "JOIN")
      .appendField(topicField("topic to check"), "TOPIC")
      .appendField(property, "PROPERTY")
      .appendField(new Blockly.FieldDropdown(OPERATORS), "OP")
      .appendField(numberField("0", "value"), "VALUE")
      .appendField(unit, "UNIT")
      .appendField(removeButton("Remove this check"));
    chain(this, CONDITION, "check");
    this.setTooltip("Compares a property of the newest message of the topic with a number.");
  });

  for (const [type, label, tooltip] of [
    ["adirf_all", "all of", "Holds while all checks inside hold."],
    ["adirf_any", "any of", "Holds while at least one check inside holds."],
    ["adirf_not", "not", "Holds while the checks inside do not all hold."],
  ] as const) {
    init(type, function () {
      this.appendDummyInput()
        .appendField("", "JOIN")
        .appendField(label)
        .appendField(button(PLUS, "Add check", (block) => buttons.addCheck(block)))
        .appendField(removeButton(`Remove this ${label}`));
      this.appendStatementInput("TERMS").setCheck(CONDITION);
      chain(this, CONDITION, "check");
      this.setTooltip(tooltip);
    });
  }

  init(
    "adirf_rule",
    function () {
      this.appendDummyInput()
        .appendField("rule")
        .appendField(textField("", "name of the rule"), "NAME")
        .appendField("priority")
        .appendField(numberField("0", "priority of the rule"), "PRIORITY")
        .appendField(removeButton("Remove this rule"));
      this.appendDummyInput()
        .appendField("IF")
        .appendField(button(PLUS, "Add check", (block) => buttons.addCheck(block)));
      this.appendStatementInput("IF").setCheck(CONDITION);
      this.appendDummyInput()
        .appendField("THEN")
        .appendField(button(PLUS, "Add rate", (block) => buttons.addRate(block, "THEN")));
      this.appendStatementInput("THEN").setCheck(ACTION);
      this.appendDummyInput("TAIL")
        .appendField("else")
        .appendField(
          button(PLUS, "Add ELSE", (block) => buttons.toggleElse(block)),
          "ADD_ELSE",
        );
      this.setStyle("rule");
      this.setTooltip("While the condition holds, the rates under THEN are in force.");
    },
    {
      setElse(this: Blockly.BlockSvg, shown: boolean) {
        if (shown === (this.getInput("ELSE") !== null)) return;
        this.removeInput(shown ? "TAIL" : "ELSE");
        if (!shown) this.removeInput("ELSE_HEAD");
        if (shown) {
          this.appendDummyInput("ELSE_HEAD")
            .appendField("ELSE")
            .appendField(button(PLUS, "Add rate to ELSE", (block) => buttons.addRate(block, "ELSE")))
            .appendField(button(MINUS, "Remove ELSE", (block) => buttons.toggleElse(block)));
          this.appendStatementInput("ELSE").setCheck(ACTION);
        } else {
          this.appendDummyInput("TAIL")
            .appendField("else")
            .appendField(
              button(PLUS, "Add ELSE", (block) => buttons.toggleElse(block)),
              "ADD_ELSE",
            );
        }
      },
      saveExtraState(this: Blockly.BlockSvg) {
        return this.getInput("ELSE") ? { hasElse: true } : null;
      },
      loadExtraState(this: RuleBlock, state: { hasElse?: boolean }) {
        this.setElse(state.hasElse === true);
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

function chain(block: Blockly.BlockSvg, type: string, style: string): void {
  block.setPreviousStatement(true, type);
  block.setNextStatement(true, type);
  block.setStyle(style);
}

function numberField(value: string, label: string, minimum?: number): Blockly.FieldNumber {
  const field = new NumberField(value, minimum);
  field.setAriaTypeName(label);
  return field;
}

function textField(value: string, label: string): Blockly.FieldTextInput {
  const field = new Blockly.FieldTextInput(value, null, { spellcheck: false });
  field.setAriaTypeName(label);
  return field;
}
