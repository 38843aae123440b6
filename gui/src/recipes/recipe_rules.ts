// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Api } from "../api/client";
import type { Statement } from "../api/types";
import { statementsIn } from "../state/statements";
import { RECIPES } from "./recipes";

/** The rules of all recipes, as the server reads them. */
export async function recipeRules(api: Api): Promise<Statement[]> {
  const text = RECIPES.map((recipe) => recipe.text).join("\n");
  const document = await api.document({ text, name: "recipes", profile_text: null });
  return statementsIn(document).filter(({ kind }) => kind === "rule");
}
