// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ProfileRepair } from "../state/profile_repair";
import { Notice } from "../ui/notice";

/** What was changed in another file than the one that is open, with the way back. */
export function ProfileChangeNotice({ repair }: { repair: ProfileRepair }) {
  const change = repair.done.value;
  if (change === null) return null;
  return <Notice kind="info" text={change.words} action={{ label: "Take it back", act: change.takeBack }} />;
}
