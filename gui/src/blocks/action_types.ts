// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import { TIERS } from "../api/types";
import { parseBound } from "./bound_text";
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
import { parseRate, RATE_WORDS, rateText } from "./rate_text";
import { SuggestionField } from "./suggestion_field";
import { parseTopics, topicsText } from "./topic_list";

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
      .appendField(rateField(unit), "RATE")
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
        propertyField("position", () => suggest.bounds(String(this.getFieldValue("TOPIC")))),
        "PROPERTY",
      )
      .appendField("within")
      .appendField(boundField(), "BOUND")
      .appendField(new Blockly.FieldLabel("m"), "UNIT")
      .appendField(removeButton("Remove this bound"));
    chain(this, ACTION, "floor");
    this.setTooltip("The operator's picture of the property is at most so much off; 0 lets every change pass.");
  });

  define("adirf_record", function () {
    this.appendDummyInput()
      .appendField("record")
      .appendField(textField("incident", "name of the recording", filled), "NAME")
      .appendField("with")
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

function rateField(unit: Blockly.FieldLabel): SuggestionField {
  return new SuggestionField(
    "10",
    () => RATE_WORDS,
    "rate",
    (text) => {
      const parsed = parseRate(text);
      unit.setValue(parsed?.kind === "hz" ? "Hz" : "");
      return parsed === null ? null : rateText(parsed);
    },
  );
}

function boundField(): SuggestionField {
  const read = (text: string) => parseBound(text)?.toString() ?? null;
  return new SuggestionField("0.05", () => TIERS, "bound", read);
}

function topicsField(suggest: Suggestions): SuggestionField {
  const read = (text: string) => topicsText(parseTopics(text));
  return new SuggestionField(topicsText([]), () => suggest.markedTopics(), "topics to record", read);
}

function filled(text: string): string | null {
  return text.trim() || null;
}
