// What the page shows, in its address: "#?a=12&mode=error&zoom=8". A link that is opened elsewhere shows the same.

const marker = "#?";
const pause = 150; // ms from a change to the address: browsers refuse many changes at once
const listeners = [];

const read = () => new Map(new URLSearchParams(location.hash.startsWith(marker) ? location.hash.slice(marker.length) : ""));
let known = read();
let is_waiting = false;

function write() {
  is_waiting = false;
  if (known.size === 0 && !location.hash.startsWith(marker)) return;
  const text = known.size > 0 ? marker + new URLSearchParams([...known]) : location.pathname + location.search;
  history.replaceState(null, "", text);
}

/** What the address says under a name, or null. */
export const recalled = (name) => known.get(name) ?? null;

/** The same as a number, or null where it is none. */
export function recalledNumber(name) {
  const text = recalled(name);
  return text !== null && text.trim() !== "" && Number.isFinite(Number(text)) ? Number(text) : null;
}

/** Puts texts into the address by name; null, false and "" take a name out of it. */
export function remember(texts) {
  for (const [name, text] of Object.entries(texts)) {
    if (text === null || text === false || text === "") known.delete(name);
    else known.set(name, String(text));
  }
  if (is_waiting) return;
  is_waiting = true;
  setTimeout(write, pause);
}

/** Calls back when another address of this page is opened, with a link or by hand. */
export const onRecall = (listener) => listeners.push(listener);

addEventListener("hashchange", () => {
  if (!location.hash.startsWith(marker)) return;
  known = read();
  listeners.forEach((listener) => listener());
});
