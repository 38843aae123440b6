// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
interface Props<T extends string | number> {
  label: string;
  value: T;
  /** Values with what is written of them; a value alone is written as it is. */
  choices: readonly (T | readonly [T, string])[];
  choose: (value: T) => void;
  /** Whether the label is not to be seen. */
  isBare?: boolean;
  disabled?: boolean;
}

/** One of some values, in a list of the browser's own. */
export function Choice<T extends string | number>(props: Props<T>) {
  const { label, value, isBare = false, disabled } = props;
  const choices = props.choices.map((each) => (typeof each === "object" ? each : ([each, String(each)] as const)));
  const list = (
    <select
      aria-label={isBare ? label : undefined}
      value={value}
      disabled={disabled}
      onChange={({ currentTarget }) => {
        const chosen = choices[currentTarget.selectedIndex];
        if (chosen) props.choose(chosen[0]);
      }}
    >
      {choices.map(([each, words]) => (
        <option key={each} value={each}>
          {words}
        </option>
      ))}
    </select>
  );
  if (isBare) return list;
  return (
    // biome-ignore lint/a11y/noLabelWithoutControl: the list is in it
    <label>
      {label}
      {list}
    </label>
  );
}
