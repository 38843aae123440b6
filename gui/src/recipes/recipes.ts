// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import type { Api } from "../api/client";
import type { Statement } from "../api/types";
import { statementsIn } from "../state/statements";
import corridor from "./corridor.adirf?raw";
import emergency from "./emergency.adirf?raw";
import battery from "./low_battery.adirf?raw";
import sensor from "./sensor_fault.adirf?raw";
import link from "./weak_link.adirf?raw";

/** A rule file to start from. */
interface Recipe {
  title: string;
  /** When and what for, in a sentence or two. */
  about: string;
  text: string;
}

/** Each recipe says in its first line what it is for. */
export const RECIPES: readonly Recipe[] = [battery, emergency, corridor, link, sensor].map((text) => {
  const [, title = "", about = ""] = /^\/\/ ([^:]+): (.*)/.exec(text) ?? [];
  return { title, about, text };
});

/** The rules of all recipes, as the server reads them. */
export async function recipeRules(api: Api): Promise<Statement[]> {
  const text = RECIPES.map((recipe) => recipe.text).join("\n");
  const document = await api.ask("POST /api/document", { text, name: "recipes", profile_text: null });
  return statementsIn(document).filter(({ kind }) => kind === "rule");
}
