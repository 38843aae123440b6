// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef, useState } from "preact/hooks";
import { Icon, type IconName } from "../ui/button";
import { useLoaded } from "../ui/later";
import { watchSize, watchTheme } from "../ui/watch";
import type { MapView } from "./map_view";
import type { MapOwner, MapPicture, MapZone, Point } from "./shapes";

/**
 * A map in metres with its buttons, the pointer's place and a scale bar; OpenLayers loads when it is first shown.
 *
 * What moves often, such as the robot, is set on the view that `opened` gets, which is null once the view is gone.
 * Without `owner` nothing on the map can be chosen, dragged or drawn. It fills its container, which needs a height.
 */
export function MapCanvas(props: {
  /** What a screen reader calls the map. */
  label: string;
  picture?: MapPicture | null;
  path?: readonly Point[];
  dots?: readonly Point[];
  zones?: readonly MapZone[];
  /** Whether the path is seen from near at first, and not all of the picture. */
  isNear?: boolean;
  /** Whether the path grows while somebody looks: a map that they moved stays where it is. */
  isLive?: boolean;
  owner?: MapOwner;
  opened?: (view: MapView | null) => void;
}) {
  const host = useRef<HTMLDivElement>(null);
  const module = useLoaded(() => import("./map_view"));
  const [view, setView] = useState<MapView | null>(null);
  const [place, setPlace] = useState<Point | null>(null);
  const [bar, setBar] = useState<{ metres: number; px: number } | null>(null);
  const [isWheeled, setIsWheeled] = useState(false);
  useEffect(() => {
    const timer = setTimeout(() => setIsWheeled(false), HINT_MS);
    return () => clearTimeout(timer);
  }, [isWheeled]);
  const latest = useRef(props);
  latest.current = props;
  useEffect(() => {
    const element = host.current;
    if (!element || module === null) return;
    const owner = { ...forwarded(() => latest.current.owner), scaled: setBar };
    const pointed = (at: Point | null) => {
      setPlace(at);
      latest.current.owner?.pointed?.(at);
    };
    return openView(module.MapView, element, { ...owner, pointed }, props.owner !== undefined, (opened) => {
      setView(opened);
      latest.current.opened?.(opened);
    });
  }, [module]);
  const { picture = null, path = NONE, dots = NONE, zones = NO_ZONES } = props;
  useEffect(() => view?.setPicture(picture), [view, picture]);
  useEffect(() => view?.setPath(path), [view, path]);
  useEffect(() => view?.setDots(dots), [view, dots]);
  useEffect(() => view?.setZones(zones), [view, zones]);
  useEffect(() => view?.fit(props.isNear ? path : []), [view, picture, props.isLive ? null : path]);
  useEffect(() => view?.resize(), [path]);
  return (
    <div class="map" onWheel={({ ctrlKey, metaKey }) => setIsWheeled(!ctrlKey && !metaKey)}>
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: the keyboard moves the map */}
      <div class="map-host" ref={host} role="application" aria-label={props.label} tabIndex={0} />
      {!view && <p class="quiet map-note">Loading the map …</p>}
      {isWheeled && <p class="map-note map-hint">Hold Ctrl to zoom with the wheel</p>}
      <div class="map-buttons">
        <MapButton label="Zoom in" icon="plus" act={() => view?.zoom(1)} />
        <MapButton label="Zoom out" icon="minus" act={() => view?.zoom(-1)} />
        <MapButton label="Show everything" icon="fit" act={() => view?.fit()} />
      </div>
      <p class="map-place" role="group" aria-label="Place of the pointer">
        {place ? `x ${place[0].toFixed(2)} m, y ${place[1].toFixed(2)} m` : ""}
      </p>
      {bar && (
        <p class="map-scale" style={{ width: `${bar.px}px` }} role="group" aria-label="Scale">
          {bar.metres} m
        </p>
      )}
    </div>
  );
}

const HINT_MS = 2000;
const NONE: readonly Point[] = [];
const NO_ZONES: readonly MapZone[] = [];

function MapButton({ label, icon, act }: { label: string; icon: IconName; act: () => void }) {
  return (
    <button type="button" class="small" aria-label={label} title={label} onClick={act}>
      <Icon name={icon} />
    </button>
  );
}

/** An owner that passes everything on to the one of now. */
function forwarded(owner: () => MapOwner | undefined): MapOwner {
  return {
    chosen: (id, rectangle) => owner()?.chosen?.(id, rectangle),
    moved: (id, by) => owner()?.moved?.(id, by),
    resized: (id, sides) => owner()?.resized?.(id, sides),
    drawn: (shape) => owner()?.drawn?.(shape),
    failed: () => owner()?.failed?.(),
  };
}

function openView(
  View: typeof MapView,
  host: HTMLElement,
  owner: MapOwner,
  isEditable: boolean,
  done: (view: MapView | null) => void,
): () => void {
  const { chosen, ...others } = owner;
  const view = new View(host, isEditable && chosen ? { ...others, chosen } : others);
  const stops = [watchSize(host, () => view.resize()), watchTheme(() => view.applyTheme())];
  done(view);
  return () => {
    for (const stop of stops) stop();
    done(null);
    view.dispose();
  };
}
