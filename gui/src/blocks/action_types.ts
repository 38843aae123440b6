// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import {
  ALL_TOPICS,
  boundProblem,
  parseBound,
  parseRate,
  parseTopics,
  rateProblem,
  rateText,
  topicsText,
} from "./field_text";
import {
  button,
  chain,
  MINUS,
  numberField,
  propertyField,
  type Suggestions,
  textField,
  timeUnitField,
  topicField,
} from "./fields";
import { SuggestionField } from "./suggestion_field";

const ACTION = "Action";

type Init = (this: Blockly.BlockSvg) => void;
type Remove = (block: Blockly.BlockSvg) => void;

/** Defines the blocks that say what happens: rates, floors, bounds and recordings. */
export function defineActionBlocks(suggest: Suggestions, remove: Remove): void {
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
