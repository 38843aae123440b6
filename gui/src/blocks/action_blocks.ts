// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { MarginState } from "./action_model";
import { change, focus, openMenu } from "./clocks";
import { parseParameter } from "./compared";
import {
  button,
  chain,
  choiceField,
  MINUS,
  nameField,
  numberField,
  PLUS,
  propertyField,
  quietButton,
  quietWords,
  SLOPE,
  SuggestionField,
  type Suggestions,
  textField,
  textOf,
  timeUnitField,
  topicField,
} from "./fields";
import { openField } from "./open_field";
import {
  ALL_TOPICS,
  boundProblem,
  parseBound,
  parseRate,
  parseTopics,
  rateProblem,
  rateText,
  topicsText,
} from "./rule_words";

export const ACTION = "Action";

/** What adds something to a part of a rule. */
export interface PartAdders {
  addRate(block: Blockly.BlockSvg, input: string): void;
  addBound(block: Blockly.BlockSvg, input: string): void;
  addRecord(block: Blockly.BlockSvg, input: string): void;
  /** Adds a parameter to set, a service to call or a note to send. */
  addAct(block: Blockly.BlockSvg, input: string, type: string): void;
}

type Init = (this: Blockly.BlockSvg) => void;

type Remove = (block: Blockly.BlockSvg) => void;

/** Defines the blocks that say what happens: rates, floors, bounds, recordings, and what else a rule does. */
export function defineActionBlocks(suggest: Suggestions, remove: Remove): void {
  const define = (type: string, init: Init, more: object = {}) => {
    Blockly.Blocks[type] = { init, ...more };
  };
  const removeButton = (label: string) => quietButton(MINUS, label, remove);
  const topicsToSend = (label: string) => topicField(suggest, label, () => suggest.patternChoices());

  define(
    "adirf_set",
    function () {
      const unit = new Blockly.FieldLabel("Hz");
      this.appendDummyInput()
        .appendField("set frequency of")
        .appendField(topicsToSend("topic to send"), "TOPIC")
        .appendField("to")
        .appendField(rateField(suggest, unit), "RATE")
        .appendField(unit, "UNIT")
        .appendField(quietButton(SLOPE, "Let a value set the rate", addMargin))
        .appendField(removeButton("Remove this rate"));
      chain(this, ACTION, "rate");
      this.setTooltip("Relays the topic at this rate. Inside a rule: while the rule's condition holds.");
    },
    marginMethods(suggest),
  );

  define("adirf_keep", function () {
    this.appendDummyInput()
      .appendField("keep")
      .appendField(topicsToSend("topic to keep"), "TOPIC")
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
      .appendField(topicsToSend("topic to bound"), "TOPIC")
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

  defineActs(suggest, removeButton);
}

/** Defines the blocks of what a rule does beside relaying and recording. */
function defineActs(suggest: Suggestions, removeButton: (label: string) => Blockly.FieldImage): void {
  const define = (type: string, tooltip: string, init: (line: Blockly.Input) => Blockly.Input) => {
    Blockly.Blocks[type] = {
      init(this: Blockly.BlockSvg) {
        init(this.appendDummyInput()).appendField(removeButton("Remove this action"));
        chain(this, ACTION, "act");
        this.setTooltip(tooltip);
      },
    };
  };
  const ofProfile = "The topic parameters on the robot say what is allowed";
  define("adirf_parameter", "Sets a parameter of a node while the rule holds, and puts back what it was.", (line) =>
    line
      .appendField("set parameter")
      .appendField(
        nameField("/node", "node of the parameter", ofProfile, () => suggest.allowed({ kind: "node" })),
        "NODE",
      )
      .appendField(
        nameField("parameter", "name of the parameter", ofProfile, (block) =>
          suggest.allowed({ kind: "parameter", node: textOf(block, "NODE") }),
        ),
        "PARAMETER",
      )
      .appendField("to")
      .appendField(textField("0", "value of the parameter", "value", parseParameter), "VALUE"),
  );
  define("adirf_call", "Calls a service once when the rule begins to hold.", (line) =>
    line
      .appendField("call")
      .appendField(
        nameField("/service", "service to call", ofProfile, () => suggest.allowed({ kind: "service" })),
        "SERVICE",
      )
      .appendField("with")
      .appendField(choiceField(ARGUMENTS, "value for the service"), "ARGUMENT"),
  );
  define("adirf_notify", "Tells people when the rule begins to hold, and when it ends.", (line) =>
    line
      .appendField("notify")
      .appendField(textField("Look at the robot", "text of the note", "what to say", notEmpty), "TEXT"),
  );
}

const ARGUMENTS: [string, string][] = [
  ["no value", ""],
  ["true", "true"],
  ["false", "false"],
];
const ACTS: readonly [string, string][] = [
  ["Set a parameter…", "adirf_parameter"],
  ["Call a service…", "adirf_call"],
  ["Notify…", "adirf_notify"],
];

/** Puts a button for each thing that a part of a rule can hold behind the part's name. */
export function appendAdders(head: Blockly.Input, part: string, ofPart: string, buttons: PartAdders): void {
  const chooseAct = (block: Blockly.BlockSvg, field: Blockly.FieldImage) => {
    if (block.isInFlyout) return;
    const choice = ([text, type]: readonly [string, string]) => ({
      text,
      enabled: true,
      callback: () => buttons.addAct(block, part, type),
    });
    openMenu(ACTS.map(choice), block, field);
  };
  head
    .appendField(button(PLUS, `Add rate${ofPart}`, (block) => buttons.addRate(block, part)))
    .appendField(quietWords("rate"))
    .appendField(quietButton(PLUS, `Add bound${ofPart}`, (block) => buttons.addBound(block, part)))
    .appendField(quietWords("bound"))
    .appendField(quietButton(PLUS, `Add recording${ofPart}`, (block) => buttons.addRecord(block, part)))
    .appendField(quietWords("recording"))
    .appendField(quietButton(PLUS, `Add action${ofPart}`, chooseAct))
    .appendField(quietWords("action"));
}

const NEW_MARGIN: Readonly<Record<string, unknown>> = { FROM: 3, TO: 0.5 };

/** What a block of a rate is given, so that a value can say how much of it holds. */
function marginMethods(suggest: Suggestions): object {
  return {
    saveExtraState(this: Blockly.BlockSvg): MarginState | null {
      return this.getInput("MARGIN") ? { hasMargin: true } : null;
    },
    loadExtraState(this: MarginBlock, { hasMargin = false }: MarginState) {
      this.showMargin(hasMargin);
    },
    showMargin(this: Blockly.BlockSvg, shown: boolean) {
      if (shown === (this.getInput("MARGIN") !== null)) return;
      if (!shown) {
        this.removeInput("MARGIN");
        return;
      }
      const unit = new Blockly.FieldLabel("Hz");
      this.appendDummyInput("MARGIN")
        .appendField("… to")
        .appendField(rateField(suggest, unit, "rate at the other end"), "TO_RATE")
        .appendField(unit)
        .appendField("as")
        .appendField(
          topicField(suggest, "topic that sets the rate", () => suggest.vitalsChoices()),
          "BY_TOPIC",
        )
        .appendField(
          propertyField("distance", (topic) => suggest.properties(topic), "BY_TOPIC"),
          "BY_PROPERTY",
        )
        .appendField("goes from")
        .appendField(numberField("3", "value at the first rate"), "FROM")
        .appendField("to")
        .appendField(numberField("0.5", "value at the other rate"), "TO")
        .appendField(new Blockly.FieldLabel(""), "BY_UNIT")
        .appendField(button(MINUS, "Set one rate again", removeMargin));
    },
  };
}

interface MarginBlock extends Blockly.BlockSvg {
  showMargin(shown: boolean): void;
}

function addMargin(block: Blockly.BlockSvg): void {
  if (block.isInFlyout) return;
  const rate = parseRate(textOf(block, "RATE"));
  change(block, () => {
    (block as MarginBlock).showMargin(true);
    // Full and Off are no ends of anything.
    if (rate?.kind !== "hz" && rate?.kind !== "tier") block.setFieldValue("2", "RATE");
    block.setFieldValue(rate?.kind === "tier" ? rate.value : "20", "TO_RATE");
    block.setFieldValue("/scan", "BY_TOPIC");
    for (const [name, value] of Object.entries(NEW_MARGIN)) block.setFieldValue(value, name);
  });
  openField(block.getField("TO_RATE"));
}

function removeMargin(block: Blockly.BlockSvg): void {
  focus(block, "RATE");
  change(block, () => (block as MarginBlock).showMargin(false));
}

function rateField(suggest: Suggestions, unit: Blockly.FieldLabel, label = "rate"): SuggestionField {
  const offer = {
    hint: "Or type a number of Hz",
    choices: (block: Blockly.Block) => {
      const rates = suggest.rates(textOf(block, "TOPIC"));
      return block.getField("TO_RATE") ? rates.filter(({ word }) => word !== "Full" && word !== "Off") : rates;
    },
    isWhole: (text: string) => parseRate(text) !== null,
    refusal: rateProblem,
  };
  return new SuggestionField("10", offer, label, (text) => {
    const parsed = parseRate(text);
    unit.setValue(parsed?.kind === "hz" ? "Hz" : "");
    return parsed === null ? null : rateText(parsed);
  });
}

function boundField(suggest: Suggestions): SuggestionField {
  const offer = {
    hint: "Or type a number",
    choices: (block: Blockly.Block) => suggest.boundLevels(textOf(block, "TOPIC"), textOf(block, "PROPERTY")),
    isWhole: (typed: string) => parseBound(typed) !== null,
    refusal: boundProblem,
  };
  return new SuggestionField("0.05", offer, "bound", (typed) => parseBound(typed)?.toString() ?? null);
}

function topicsField(suggest: Suggestions): SuggestionField {
  const read = (text: string) => topicsText(parseTopics(text));
  const offer = {
    hint: "Several topics have a blank between them",
    choices: () => [
      { word: ALL_TOPICS, note: "whatever they are by then" },
      ...suggest.topicChoices(),
      ...suggest.patternChoices(),
    ],
    isWhole: (text: string) => text === "" || text.startsWith("/") || text === ALL_TOPICS,
    refusal: () => "",
    unknown: () => suggest.unknown(),
    head: (text: string) => /^.*[\s,]/.exec(text)?.[0] ?? "",
  };
  return new SuggestionField(topicsText([]), offer, "topics to record", read);
}

function filled(text: string): string | null {
  return text.trim() || null;
}

function notEmpty(text: string): string | null {
  return text.trim() === "" ? null : text;
}
