// The page of the search. What it searches is one file, which is read when this page opens.

import { h, plural } from "../../html/web/dom.js";
import { onRecall, recalled, remember } from "../../html/web/page_state.js";

const most = 100; // results that are shown
const room = 90; // letters of text to each side of a word
const ranks = ["technique", "scene", "machine", "suite", "table", "differences", "documentation", "file", "row"];

const wordsOf = (text) => text.toLowerCase().split(/\s+/).filter(Boolean);

/** Entries with all words: those that have them in their heading first, within these by kind. */
function found(entries, words) {
  const scoreOf = ({ heading, kind, all }) => {
    if (!words.every((word) => all.includes(word))) return null;
    const low = heading.toLowerCase();
    const place = low === words.join(" ") ? 0 : words.every((word) => low.includes(word)) ? 1 : 2;
    return 100 * place + ranks.indexOf(kind);
  };
  return entries
    .map((entry, index) => ({ entry, index, score: scoreOf(entry) }))
    .filter(({ score }) => score !== null)
    .sort((p, q) => p.score - q.score || p.index - q.index)
    .map(({ entry }) => entry);
}

/** Some text around the first word that occurs, with the words marked. */
function excerpt(text, words) {
  const low = text.toLowerCase();
  const at = Math.min(...words.map((word) => low.indexOf(word)).filter((place) => place >= 0));
  if (!Number.isFinite(at)) return text.slice(0, 2 * room);
  const from = Math.max(0, at - room);
  const word = words.find((one) => low.startsWith(one, at));
  const before = (from > 0 ? "\u2026 " : "") + text.slice(from, at);
  const after = text.slice(at + word.length, at + word.length + room);
  return [before, h("mark", {}, text.slice(at, at + word.length)), after, at + word.length + room < text.length && " \u2026"];
}

function show(entries, query, status, results) {
  const words = wordsOf(query);
  const hits = words.length > 0 ? found(entries, words) : [];
  const rest = hits.length > most ? `, the first ${most} are shown` : "";
  status.textContent = words.length > 0 ? `${plural(hits.length, "result")}${rest}` : "Type a word: a technique, a scene, a machine, a cause, any text of the documentation.";
  const item = ({ path, heading, kind, text }) =>
    h("li", {}, h("a", { href: path }, heading), " ", h("small", { class: "kind" }, kind), text && h("p", {}, excerpt(text, words)));
  results.replaceChildren(...hits.slice(0, most).map(item));
}

export function showSearch() {
  const form = document.getElementById("search");
  if (!form) return;
  const input = form.querySelector("input");
  const [status, results] = [document.getElementById("found"), document.getElementById("results")];
  // A form of another page asks in the query of the address.
  input.value = recalled("q") ?? new URLSearchParams(location.search).get("q") ?? "";
  status.textContent = "Reading what can be found \u2026";
  window.gnomonFound = (list) => {
    const entries = list.map(([path, heading, kind, text]) => ({ path, heading, kind, text, all: `${heading} ${kind} ${text}`.toLowerCase() }));
    const draw = () => show(entries, input.value, status, results);
    const changed = () => {
      remember({ q: input.value });
      draw();
    };
    input.addEventListener("input", changed);
    onRecall(() => {
      input.value = recalled("q") ?? "";
      draw();
    });
    draw();
    results.dataset.ready = "";
  };
  form.addEventListener("submit", (event) => event.preventDefault());
  document.head.append(h("script", { src: "assets/search.js", onerror: () => (status.textContent = "assets/search.js cannot be read.") }));
  input.focus();
}
