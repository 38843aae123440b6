// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** Opens something once its module is loaded; returns how to close it, which may be before that. */
export function onceLoaded<M>(loading: Promise<M>, open: (module: M) => () => void): () => void {
  let isLeft = false;
  let close: (() => void) | null = null;
  void loading.then((module) => {
    if (!isLeft) close = open(module);
  });
  return () => {
    isLeft = true;
    close?.();
  };
}
