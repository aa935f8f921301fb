// What the program told the page. Rows keep the order of the run; values are raw, texts are for people.

export const data = JSON.parse(document.getElementById("data").textContent);

data.columns.forEach((column, index) => (column.index = index));
data.rows.forEach((row, index) => {
  row.index = index;
  row.best = new Set(row.best);
  row.floored = new Set(row.floored);
  row.flagged = new Set(row.flagged);
});

const columns = new Map(data.columns.map((column) => [column.name, column]));

/** The column of that name, or undefined. */
export const columnNamed = (name) => columns.get(name);

/** Number, text or null. */
export const valueOf = (row, name) => (columns.has(name) ? row.values[columns.get(name).index] : null);

/** What the table shows in a column's cell. */
export const textOf = (row, column) => row.texts[column.index] ?? row.values[column.index] ?? "-";

export const isOk = (row) => row.status === "ok";

/** Different values in order of appearance. */
export const distinct = (items) => [...new Set(items)];

/** What is asked at each pixel: a "binary" answer, a "fraction" of the light, or the light "received" of several. */
export const answerOf = (row) => data.groups[row.group].answer;

/** Whether errors of the row's pixels are differences of shares, not wrong pixels. */
export const isSoft = (row) => answerOf(row) !== "binary";

/** How far the row's error lies below that of the best constant mask; infinite where that is not known. */
export const gainOverConstant = (row) => {
  const [error, constant] = ["error", "constant_error"].map((name) => valueOf(row, name));
  return error === null || constant === null ? Infinity : constant - error;
};

/** What tells a group from the others: parts that are the same everywhere are left out. */
const namesOfGroups = (() => {
  // A scene that is a file goes by the file's name, where that says which.
  const scenes = distinct(data.groups.map((group) => group.scene));
  const short = (scene) => scene.replace(/^[^:]*\//, "");
  const sceneName = (scene) => (scenes.filter((other) => short(other) === short(scene)).length > 1 ? scene : short(scene));
  const varies = (key) => distinct(data.groups.map((group) => group[key])).length > 1;
  const size = (group) => `${group.width} x ${group.height}`;
  const sizes = distinct(data.groups.map(size)).length > 1;
  return data.groups.map((group) =>
    [
      sceneName(group.scene),
      group.light,
      varies("view") && group.view,
      group.path && `path ${group.path}`,
      sizes && size(group),
      varies("truth") && `${group.truth} truth`,
    ]
      .filter(Boolean)
      .join(" \u00b7 "),
  );
})();

export const groupName = (index) => namesOfGroups[index];

/** What each cause holds of a row's wrong rate, under a light with area of its mean error, in the order of data.causes; null where the run did not look for causes. */
export const causeShares = (row) => row.causes;

/** Techniques in order of appearance: what colors and symbols go by, in every plot and under every filter. */
export const techniques = distinct(data.rows.map((row) => row.technique));
