// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef, useState } from "preact/hooks";
import { type Route, toRoute } from "../route";
import { browserStorage } from "../state/drafts";
import { Button } from "../ui/button";
import { focusPageSoon } from "../ui/dialog";

const KEY = "tour";

/**
 * Offers the tour when the page is opened for the first time; an answer is for good.
 *
 * Beside rules it is gone as soon as somebody works on them, and back on the home screen.
 */
export function TourOffer({ route }: { route: Route }) {
  const [isNew, setNew] = useState(() => !knowsTour());
  const [isAside, setAside] = useState(false);
  const card = useRef<HTMLElement>(null);
  const yes = useRef<HTMLButtonElement>(null);
  const isBesideRules = isNew && route.page === "rules";
  const isShown = (isNew && route.page === "home") || (isBesideRules && !isAside);
  useEffect(() => {
    if (isShown && document.activeElement === document.body) yes.current?.focus();
  }, []);
  useEffect(() => {
    if (!isBesideRules) return setAside(false);
    const work = ({ target }: Event) => setAside((is) => is || !card.current?.contains(target as Node));
    addEventListener("pointerdown", work, true);
    addEventListener("input", work, true);
    return () => {
      removeEventListener("pointerdown", work, true);
      removeEventListener("input", work, true);
    };
  }, [isBesideRules]);
  const isTaken = route.page === "tour";
  useEffect(() => {
    if (!isTaken) return;
    rememberTour();
    setNew(false);
  }, [isTaken]);
  const answer = (wants: boolean) => {
    if (!wants) {
      rememberTour();
      setNew(false);
      return focusPageSoon();
    }
    const rules = route.page === "rules" ? { rules: route.name } : {};
    toRoute({ page: "tour", name: "", ...rules });
  };
  if (!isShown) return null;
  return (
    <section
      ref={card}
      class="tour-card tour-offer"
      role="dialog"
      aria-modal="false"
      aria-label="A tour in five steps?"
      aria-describedby="tour-offer"
      onKeyDown={(event) => event.key === "Escape" && answer(false)}
    >
      <h2>New here?</h2>
      <p id="tour-offer">
        Five steps on an example show what is where. It takes a minute, and your files stay as they are.
      </p>
      <div class="row end">
        <Button label="No, thanks" onClick={() => answer(false)} />
        <button type="button" class="primary" ref={yes} onClick={() => answer(true)}>
          Take the tour
        </button>
      </div>
    </section>
  );
}

/** Whether somebody took the tour in this browser, or did not want it. */
function knowsTour(): boolean {
  return browserStorage().getItem(KEY) !== null;
}

/** Offers the tour never again. */
function rememberTour(): void {
  try {
    browserStorage().setItem(KEY, "seen");
  } catch {
    // A browser without room offers it again.
  }
}
