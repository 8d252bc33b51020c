"use strict";
// Sorting and filtering of the table of frames; enlarging of overlays. Without script the page shows all there is.
(() => {
  const table = document.getElementById("frame-table");
  if (table === null) return; // a flight without images has neither frames nor overlays
  const body = table.tBodies[0];
  const rows = Array.from(body.rows);
  const heads = Array.from(table.tHead.rows[0].cells);
  const field = (name) => document.getElementById("filter-" + name);

  const compare = (column, sign) => (a, b) => {
    const [p, q] = [a, b].map((row) => row.cells[column].textContent);
    if (column < 2) return sign * p.localeCompare(q, "en", { numeric: true });
    const [x, y] = [parseFloat(p), parseFloat(q)];
    if (isNaN(x) || isNaN(y)) return isNaN(x) - isNaN(y); // frames without a number stay last in both directions
    return sign * (x - y);
  };

  const sort = (column) => {
    const descending = heads[column].getAttribute("aria-sort") === "ascending";
    heads.forEach((head) => head.removeAttribute("aria-sort"));
    heads[column].setAttribute("aria-sort", descending ? "descending" : "ascending");
    body.append(...rows.sort(compare(column, descending ? -1 : 1)));
  };

  const filter = () => {
    const name = field("name").value.toLowerCase();
    const status = field("status").value;
    const near = field("near").valueAsNumber;
    const far = field("far").valueAsNumber;
    let shown = 0;
    for (const row of rows) {
      const range = parseFloat(row.cells[2].textContent);
      row.hidden = !row.cells[0].textContent.toLowerCase().includes(name)
        || (status !== "" && row.cells[1].textContent !== status)
        || range < near || range > far;
      shown += row.hidden ? 0 : 1;
    }
    document.getElementById("shown").textContent = `${shown} of ${rows.length} frames`;
  };

  heads.forEach((head, column) => head.querySelector("button").addEventListener("click", () => sort(column)));
  ["name", "status", "near", "far"].forEach((name) => field(name).addEventListener("input", filter));
  document.querySelector(".filter").addEventListener("submit", (event) => event.preventDefault());

  const large = document.getElementById("large");
  const thumbs = Array.from(document.querySelectorAll(".thumb"));
  let current = 0;
  const show = (index) => {
    current = (index + thumbs.length) % thumbs.length;
    const image = thumbs[current].querySelector("img");
    large.querySelector("img").src = image.src;
    large.querySelector("img").alt = image.alt;
    large.querySelector("p").textContent = thumbs[current].querySelector("span").textContent;
  };
  thumbs.forEach((thumb, index) => thumb.addEventListener("click", () => { show(index); large.showModal(); }));
  document.getElementById("previous").addEventListener("click", () => show(current - 1));
  document.getElementById("next").addEventListener("click", () => show(current + 1));
  document.getElementById("close").addEventListener("click", () => large.close());
  large.addEventListener("click", (event) => { if (event.target === large) large.close(); });
  large.addEventListener("close", () => thumbs[current].focus());
  large.addEventListener("keydown", (event) => {
    if (event.key === "ArrowLeft") show(current - 1);
    if (event.key === "ArrowRight") show(current + 1);
  });
})();
