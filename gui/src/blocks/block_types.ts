// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { RuleStatement } from "../api/types";
import { CLOCK_METHODS, chooseTime } from "./clocks";
import {
  button,
  CLOCK,
  COPY,
  chain,
  DOWN,
  MINUS,
  numberField,
  OPEN,
  operatorField,
  PLUS,
  propertyField,
  SHUT,
  SuggestionField,
  type Suggestions,
  SWITCH,
  textField,
  thresholdField,
  timeUnitField,
  topicField,
  UP,
} from "./fields";
import { FOLDED, type FoldedRule, type RuleBlock } from "./model";
import {
  ALL_TOPICS,
  boundProblem,
  parseBound,
  parseRate,
  parseTopics,
  rateProblem,
  rateText,
  ruleName,
  ruleSets,
  topicsText,
} from "./rule_words";

/** What the small buttons on blocks do. */
export interface BlockButtons {
  addCheck(block: Blockly.BlockSvg): void;
  addRate(block: Blockly.BlockSvg, input: string): void;
  addBound(block: Blockly.BlockSvg, input: string): void;
  addRecord(block: Blockly.BlockSvg, input: string): void;
  toggleElse(block: Blockly.BlockSvg): void;
  remove(block: Blockly.BlockSvg): void;
  /** Folds a rule to one line, or unfolds it. */
  toggleFold(block: Blockly.BlockSvg): void;
  /** Does something with a whole rule, in the text. */
  act(block: Blockly.BlockSvg, act: RuleAct): void;
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
const CONDITION = "Condition";
const ACTION = "Action";
const LONGEST_RAW_LINES = 8;

type Init = (this: Blockly.BlockSvg) => void;

/** Defines every block of the language, once for a page. */
export function defineBlocks(suggest: Suggestions, buttons: BlockButtons): void {
  const removeButton = (label: string) => button(MINUS, label, (block) => buttons.remove(block));
  const init = (type: string, define: Init, more: object = {}) => {
    Blockly.Blocks[type] = { init: define, ...more };
  };

  const addElse = (block: Blockly.BlockSvg) => buttons.toggleElse(block);
  const appendElseButton = (rule: Blockly.BlockSvg) =>
    rule
      .appendDummyInput("TAIL")
      .appendField("else")
      .appendField(button(PLUS, "Add ELSE", addElse), "ADD_ELSE");

  defineActionBlocks(suggest, buttons.remove);
  defineFolded(buttons.toggleFold);

  init(
    "adirf_check",
    function () {
      this.appendDummyInput()
        .appendField("", "JOIN")
        .appendField(topicField(suggest, "topic to check", suggest.vitalsChoices), "TOPIC")
        .appendField(
          propertyField("pose_x", (topic) => suggest.properties(topic)),
          "PROPERTY",
        )
        .appendField(operatorField(), "OP")
        .appendField(thresholdField(suggest), "VALUE")
        .appendField(new Blockly.FieldLabel(""), "UNIT")
        .appendField(button(CLOCK, "Add time", chooseTime), "CLOCK")
        .appendField(removeButton("Remove this check"));
      chain(this, CONDITION, "check");
      this.setTooltip("Compares a property of the newest message of the topic with a number.");
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
          .appendField(button(CLOCK, "Add time", chooseTime), "CLOCK")
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
        .appendField("priority")
        .appendField(numberField("0", "priority of the rule"), "PRIORITY")
        .appendField(
          button(SWITCH, SWITCH_OFF, (block) => buttons.act(block, "switch")),
          "SWITCH",
        )
        .appendField(button(COPY, "Duplicate this rule", (block) => buttons.act(block, "duplicate")))
        .appendField(button(UP, "Move this rule up", (block) => buttons.act(block, "up")))
        .appendField(button(DOWN, "Move this rule down", (block) => buttons.act(block, "down")))
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
          head.appendField(button(MINUS, "Remove ELSE", (block) => buttons.toggleElse(block)));
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

/** Puts a button for each thing that a part of a rule can hold behind the part's name. */
function appendAdders(head: Blockly.Input, part: string, ofPart: string, buttons: BlockButtons): void {
  head
    .appendField(button(PLUS, `Add rate${ofPart}`, (block) => buttons.addRate(block, part)))
    .appendField("rate")
    .appendField(button(PLUS, `Add bound${ofPart}`, (block) => buttons.addBound(block, part)))
    .appendField("bound")
    .appendField(button(PLUS, `Add recording${ofPart}`, (block) => buttons.addRecord(block, part)))
    .appendField("recording");
}

/** Fills a raw block with the first lines of its text. */
export function showRawText(block: Blockly.Block, text: string): void {
  const lines = text.split(/\r?\n/);
  const shown = lines.length > LONGEST_RAW_LINES ? [...lines.slice(0, LONGEST_RAW_LINES), "…"] : lines;
  for (const line of shown) block.appendDummyInput().appendField(line.replaceAll("\t", "  ") || " ");
}

type Remove = (block: Blockly.BlockSvg) => void;

/** Defines the blocks that say what happens: rates, floors, bounds and recordings. */
function defineActionBlocks(suggest: Suggestions, remove: Remove): void {
  const define = (type: string, init: Init) => {
    Blockly.Blocks[type] = { init };
  };
  const removeButton = (label: string) => button(MINUS, label, remove);

  define("adirf_set", function () {
    const unit = new Blockly.FieldLabel("Hz");
    this.appendDummyInput()
      .appendField("set frequency of")
      .appendField(topicField(suggest, "topic to send"), "TOPIC")
      .appendField("to")
      .appendField(rateField(suggest, unit), "RATE")
      .appendField(unit, "UNIT")
      .appendField(removeButton("Remove this rate"));
    chain(this, ACTION, "rate");
    this.setTooltip("Relays the topic at this rate. Inside a rule: while the rule's condition holds.");
  });

  define("adirf_keep", function () {
    this.appendDummyInput()
      .appendField("keep")
      .appendField(topicField(suggest, "topic to keep"), "TOPIC")
      .appendField("at least at")
      .appendField(numberField("1", "floor in Hz", 0), "HZ")
      .appendField("Hz")
      .appendField(removeButton("Remove this floor"));
    this.setStyle("floor");
    this.setTooltip("A floor: no rule and no optimizer goes below it.");
  });

  define("adirf_within", function () {
    this.appendDummyInput()
      .appendField("keep")
      .appendField(topicField(suggest, "topic to bound"), "TOPIC")
      .appendField(
        propertyField("position", (topic) => suggest.bounds(topic)),
        "PROPERTY",
      )
      .appendField("within")
      .appendField(boundField(suggest), "BOUND")
      .appendField(new Blockly.FieldLabel("m"), "UNIT")
      .appendField(removeButton("Remove this bound"));
    chain(this, ACTION, "floor");
    this.setTooltip("The operator's picture of the property is at most so much off; 0 lets every change pass.");
  });

  define("adirf_record", function () {
    this.appendDummyInput()
      .appendField("record")
      .appendField(textField("incident", "name of the recording", "name this recording", filled), "NAME")
      .appendField(topicsField(suggest), "TOPICS");
    const window = this.appendDummyInput();
    for (const [word, value] of [
      ["before", 30],
      ["after", 10],
    ] as const) {
      const name = word.toUpperCase();
      window
        .appendField(word)
        .appendField(numberField(String(value), `time ${word}`, 0), name)
        .appendField(timeUnitField(`unit of the time ${word}`), `${name}_UNIT`);
    }
    window.appendField(removeButton("Remove this recording"));
    chain(this, ACTION, "record");
    this.setTooltip("When the rule begins to hold, keeps the topics as they were at the source, from before to after.");
  });
}

function rateField(suggest: Suggestions, unit: Blockly.FieldLabel): SuggestionField {
  const offer = {
    hint: "Or type a number of Hz",
    choices: (block: Blockly.Block) => suggest.rates(String(block.getFieldValue("TOPIC"))),
    isWhole: (text: string) => parseRate(text) !== null,
    refusal: rateProblem,
  };
  return new SuggestionField("10", offer, "rate", (text) => {
    const parsed = parseRate(text);
    unit.setValue(parsed?.kind === "hz" ? "Hz" : "");
    return parsed === null ? null : rateText(parsed);
  });
}

function boundField(suggest: Suggestions): SuggestionField {
  const text = (block: Blockly.Block, field: string) => String(block.getFieldValue(field));
  const offer = {
    hint: "Or type a number",
    choices: (block: Blockly.Block) => suggest.boundLevels(text(block, "TOPIC"), text(block, "PROPERTY")),
    isWhole: (typed: string) => parseBound(typed) !== null,
    refusal: boundProblem,
  };
  return new SuggestionField("0.05", offer, "bound", (typed) => parseBound(typed)?.toString() ?? null);
}

function topicsField(suggest: Suggestions): SuggestionField {
  const read = (text: string) => topicsText(parseTopics(text));
  const offer = {
    hint: "Several topics have a blank between them",
    choices: () => [{ word: ALL_TOPICS, note: "whatever they are by then" }, ...suggest.topicChoices()],
    isWhole: (text: string) => text === "" || text.startsWith("/") || text === ALL_TOPICS,
    refusal: () => "",
    head: (text: string) => /^.*[\s,]/.exec(text)?.[0] ?? "",
  };
  return new SuggestionField(topicsText([]), offer, "topics to record", read);
}

function filled(text: string): string | null {
  return text.trim() || null;
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
