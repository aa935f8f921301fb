// A list of the scenes and lights that have something to plot under the filter.

import { data, distinct, groupName } from "./data.js";
import { chooser } from "./dom.js";
import { filteredRows } from "./filter.js";

export const everywhere = "all";

/**
 * `isWanted(row)` says which rows count. `with_all` leads with "over all", which is not chosen unless somebody does. Null when no
 * row of the run counts. `rows()` are those of the choice; the list then holds what the filter leaves, the choice kept where it can.
 */
export function placeList(label, isWanted, redraw, with_all = false) {
  const options = (rows) => {
    const groups = distinct(rows.map((row) => row.group)).map((group) => ({ value: String(group), text: groupName(group) }));
    return with_all && groups.length > 1 ? [{ value: everywhere, text: "over all" }, ...groups] : groups;
  };
  const all = data.rows.filter(isWanted);
  if (all.length === 0) return null;
  let wanted = String(all[0].group);
  const list = chooser(label, options(all), (value) => ((wanted = value), redraw()), { name: "where" });
  list.value = wanted;
  const rows = () => {
    const passing = filteredRows().filter(isWanted),
      left = options(passing);
    const first = left.find((option) => option.value !== everywhere)?.value;
    list.set(left, left.some((option) => option.value === wanted) ? wanted : first);
    return list.value === everywhere ? passing : passing.filter((row) => row.group === Number(list.value));
  };
  return {
    element: list.element,
    rows,
    get isAll() {
      return list.value === everywhere;
    },
  };
}
