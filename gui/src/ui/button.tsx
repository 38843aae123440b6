// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentProps } from "preact";

/** A button with words on it, which sends no form. */
export function Button({ label, ...how }: Omit<ComponentProps<"button">, "label"> & { label: string }) {
  return (
    <button type="button" {...how}>
      {label}
    </button>
  );
}
