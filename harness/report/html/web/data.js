// The data that the program wrote into the page. Rows keep the order of the run; values are raw, texts are for people.
//
// `causes` of a row: the share of each cause of data.causes in the row's wrong rate, under a light with area in its mean error;
// null where the run did not find causes.

export const data = JSON.parse(document.getElementById("data").textContent);

data.columns.forEach((column, index) => (column.index = index));
data.rows.forEach((row, index) => {
  row.index = index;
  for (const marked of ["best", "floored", "flagged"]) row[marked] = new Set(row[marked]);
});

const columns = new Map(data.columns.map((column) => [column.name, column]));

/** The column of that name, or undefined. */
export const columnNamed = (name) => columns.get(name);

/** Number, text or null. */
export const valueOf = (row, name) => (columns.has(name) ? row.values[columns.get(name).index] : null);

/** What the table shows in a column's cell. */
export const textOf = (row, column) => row.texts[column.index] ?? row.values[column.index] ?? "-";

export const isOk = (row) => row.status === "ok";

/** Joins the texts that are given: not false, null, undefined or empty. */
export const joined = (texts, between = " ") => texts.filter(Boolean).join(between);

export const sum = (values) => values.reduce((total, value) => total + value, 0);

export const mean = (values) => sum(values) / values.length;

export const clamp = (value, least, most) => Math.max(least, Math.min(most, value));

/** Different values in order of appearance. */
export const distinct = (items) => [...new Set(items)];

/** The answer at each pixel: "binary", a "fraction" of a light with area, the share "received" of several, or "transmitted". */
export const answerOf = (row) => data.groups[row.group].answer;

/** Whether errors of the row's pixels are differences of shares, not wrong pixels: every pixel that is off has a cause. */
export const isSoft = (row) => ["fraction", "received"].includes(answerOf(row));

/** By how much the row's error is below that of the best constant mask; infinite where the row lacks one of them. */
export const gainOverConstant = (row) => {
  const [error, constant] = ["error", "constant_error"].map((name) => valueOf(row, name));
  return error === null || constant === null ? Infinity : constant - error;
};

/** Names that distinguish the groups: parts that all groups share are left out. */
const namesOfGroups = (() => {
  // The name of a scene's file, without its folder where that is unique.
  const scenes = distinct(data.groups.map((group) => group.scene));
  const short = (scene) => scene.replace(/^[^:]*\//, "");
  const sceneName = (scene) => (scenes.filter((other) => short(other) === short(scene)).length > 1 ? scene : short(scene));
  const varies = (key) => distinct(data.groups.map((group) => group[key])).length > 1;
  const size = (group) => `${group.width} x ${group.height}`;
  const sizes = distinct(data.groups.map(size)).length > 1;
  return data.groups.map((group) => {
    const parts = [sceneName(group.scene), group.light, varies("view") && group.view, group.path && `path ${group.path}`];
    return joined([...parts, sizes && size(group), varies("truth") && `${group.truth} truth`], " \u00b7 ");
  });
})();

export const groupName = (index) => namesOfGroups[index];

/** Techniques in order of appearance. */
export const techniques = distinct(data.rows.map((row) => row.technique));
