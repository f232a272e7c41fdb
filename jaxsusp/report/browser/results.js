"use strict";
// Tables that sort by a click on a heading: up, down, and as they were.

/** What a cell sorts by: its number, or its text. */
function keyOf(row, column) {
  const cell = row.cells[column];
  return "value" in cell.dataset ? Number(cell.dataset.value) : cell.textContent;
}

function compare(one, other) {
  if (typeof one === "number" && typeof other === "number") {
    if (Number.isNaN(one) || Number.isNaN(other)) return Number.isNaN(one) - Number.isNaN(other);
    return one - other;
  }
  return String(one).localeCompare(String(other), undefined, { numeric: true });
}

for (const table of document.querySelectorAll("table")) {
  const body = table.tBodies[0], rows = [...body.rows];
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => head.querySelector("button").addEventListener("click", () => {
    const order = { ascending: "descending", descending: "none" }[head.getAttribute("aria-sort")] || "ascending";
    for (const each of heads) each.removeAttribute("aria-sort");
    const sorted = [...rows];
    if (order !== "none") {
      head.setAttribute("aria-sort", order);
      const sign = order === "ascending" ? 1 : -1;
      sorted.sort((one, other) => {
        const first = keyOf(one, column), second = keyOf(other, column);
        if (Number.isNaN(first) || Number.isNaN(second)) return compare(first, second); // last either way
        return sign * compare(first, second);
      });
    }
    body.append(...sorted);
  }));
}
