// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** A name that goes on in the next line behind its folders and words, and before its ending. */
export function Breakable({ name }: { name: string }) {
  return name.split(/(?<=[/_-])|(?=\.\w+$)/).map((part, at) => (
    <>
      {at > 0 && <wbr />}
      {part}
    </>
  ));
}
