// A list of the scenes and lights that have something to plot under the filter.

import { data, distinct, groupName, answerOf } from "./data.js";
import { chooser } from "./dom.js";
import { filteredRows } from "./filter.js";

/** Several places at once. Few settings have rows of several kinds of answer. */
const everywhere = [
  { value: "all", text: "over all", accepts: () => true },
  { value: "all-hard", text: "over all lights without area", accepts: (row) => answerOf(row) === "binary" },
  { value: "all-soft", text: "over all lights with area", accepts: (row) => answerOf(row) === "fraction" },
  { value: "all-several", text: "over all rows of several lights", accepts: (row) => answerOf(row) === "received" },
  { value: "all-glass", text: "over all rows behind glass", accepts: (row) => answerOf(row) === "transmitted" },
];
const choicesOfAll = (rows) => {
  const is_mixed = distinct(rows.map(answerOf)).length > 1;
  const groupsOf = ({ accepts }) => new Set(rows.filter(accepts).map((row) => row.group)).size;
  return (is_mixed ? everywhere.slice(1) : everywhere.slice(0, 1)).filter((choice) => groupsOf(choice) > 1);
};

/**
 * `isWanted(row)` says which rows count. `with_all` leads with "over all", of each kind of light where there are both; the first
 * choice is a single place. Null when no row of the run counts. `rows()` are those of the choice. It first reduces the list to
 * what the filter leaves and keeps the choice where it can.
 */
export function placeList(label, isWanted, redraw, with_all = false) {
  const options = (rows) => {
    const groups = distinct(rows.map((row) => row.group)).map((group) => ({ value: String(group), text: groupName(group) }));
    return with_all ? [...choicesOfAll(rows), ...groups] : groups;
  };
  const chosenOfAll = () => everywhere.find((choice) => choice.value === list.value);
  const all = data.rows.filter(isWanted);
  if (all.length === 0) return null;
  let wanted = String(all[0].group);
  const list = chooser("where", options(all), (value) => { wanted = value; redraw(); }, label);
  list.value = wanted;
  const rows = () => {
    const passing = filteredRows().filter(isWanted);
    const left = options(passing);
    const first = left.find((option) => !everywhere.includes(option))?.value;
    list.set(left, left.some((option) => option.value === wanted) ? wanted : first);
    return passing.filter(chosenOfAll()?.accepts ?? ((row) => row.group === Number(list.value)));
  };
  return { element: list.element, rows, isAll: () => Boolean(chosenOfAll()) };
}
