// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useState } from "preact/hooks";
import { type Api, refusal } from "../api/client";
import type { LevelledProperty } from "../api/types";
import { ACCURACY_UNITS, keysOf } from "../state/accuracies";
import type { DraftRow } from "../state/draft_row";
import type { ProfileEditor } from "../state/profile_editor";
import { Choice } from "../ui/choice";
import { AccuracyLevels } from "./accuracy_levels";
import { RateLevels } from "./rate_levels";

const RATES_OF = "Rates";
const PROPERTIES = Object.keys(ACCURACY_UNITS) as LevelledProperty[];
const accuracyOf = (property: LevelledProperty) => `Accuracy of ${property}`;

/** The six levels of one topic: of its rate, or of the accuracy of a property. */
export function LevelPanel({ editor, api, bags }: { editor: ProfileEditor; api: Api; bags: string[] }) {
  const rows = editor.rows.value.filter((row) => row.topic.trim() !== "");
  const [topic, setTopic] = useState("");
  const [bag, setBag] = useState("");
  const [levelsOf, setLevelsOf] = useState(RATES_OF);
  const known = useKnown(editor, api, rows);
  const row = rows.find((each) => each.topic === topic) ?? rows[0];
  if (!row) return null;
  const properties = PROPERTIES.filter(
    (each) => known.get(row.topic)?.has(each) || row.accuracies[keysOf(ACCURACY_UNITS[each])[0]] !== null,
  );
  const property = properties.find((each) => accuracyOf(each) === levelsOf);
  return (
    <section class="levels" aria-label="Quality levels on the curve">
      <h2>Quality levels of a topic</h2>
      <p class="quiet">
        Drag the lines, or move them with the arrow keys. The table follows. A recording shows what each rate would
        lose, and what each accuracy would need.
      </p>
      <div class="row">
        <Choice label="Topic" value={row.topic} choices={rows.map((each) => each.topic)} choose={setTopic} />
        {properties.length > 0 && (
          <Choice
            label="Levels of"
            value={property ? accuracyOf(property) : RATES_OF}
            choices={[RATES_OF, ...properties.map(accuracyOf)]}
            choose={setLevelsOf}
          />
        )}
        {bags.length > 0 && <Choice label="Recording" value={bag} choices={[["", "none"], ...bags]} choose={setBag} />}
      </div>
      {property ? (
        <AccuracyLevels {...{ editor, api, row, bag, property }} />
      ) : (
        <RateLevels {...{ editor, api, row, bag }} />
      )}
    </section>
  );
}

/** What the server knows to be in messages of each topic of the table. */
function useKnown(editor: ProfileEditor, api: Api, rows: readonly DraftRow[]): ReadonlyMap<string, Set<string>> {
  const [known, setKnown] = useState<ReadonlyMap<string, Set<string>>>(new Map());
  const ask = async () => {
    try {
      const { topics } = await api.vocabulary("", editor.typesText);
      setKnown(new Map(topics.map((each) => [each.topic, new Set(each.bounds.map(({ name }) => name))])));
    } catch (error) {
      // Nothing is known then, and the levels of rates are all there is.
      refusal(error);
    }
  };
  const types = rows.map((row) => row.type).join(" ");
  useEffect(() => void ask(), [types, editor.isSaved.value]);
  return known;
}
