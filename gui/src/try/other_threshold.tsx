// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Signal } from "@preact/signals";
import { NeedsServer } from "../ui/server_gone";

interface Props {
  threshold: Signal<number>;
  /** The threshold that the rules have. */
  written: number;
  write: (threshold: number) => void;
}

/** What can be done with a threshold that was dragged: it goes into the rules, or back to theirs. */
export function OtherThreshold({ threshold, written, write }: Props) {
  const { value } = threshold;
  if (value === written) return null;
  return (
    <NeedsServer>
      <div class="row">
        <button type="button" class="small" onClick={() => write(value)}>
          Write {value} into the rules
        </button>
        <button type="button" class="small" onClick={() => (threshold.value = written)}>
          Back to {written}
        </button>
      </div>
    </NeedsServer>
  );
}
