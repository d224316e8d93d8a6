"use strict";
// A click on a head sorts its table, a second one the other way; rows without a value come last.
for (const table of document.querySelectorAll("table")) {
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => head.firstElementChild.addEventListener("click", () => {
    const sign = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
    heads.forEach((other) => other.removeAttribute("aria-sort"));
    head.setAttribute("aria-sort", sign === 1 ? "ascending" : "descending");
    const isNumber = head.classList.contains("n");
    const value = (row) => row.cells[column].dataset.v;
    const rows = [...table.tBodies[0].rows].sort((a, b) => {
      const [x, y] = [value(a), value(b)];
      if (x === "" || y === "") return (x === "") - (y === "");
      return sign * (isNumber ? Number(x.replace("inf", "Infinity")) - Number(y.replace("inf", "Infinity")) : x.localeCompare(y));
    });
    table.tBodies[0].append(...rows);
  }));
}
// A slider shows as much of the picture at its left as it says.
for (const pair of document.querySelectorAll(".pair")) {
  const input = pair.querySelector("input");
  const top = pair.querySelector(".top");
  const show = () => { top.style.clipPath = `inset(0 ${100 - input.value}% 0 0)`; };
  input.addEventListener("input", show);
  const stack = pair.querySelector(".stack");
  const drag = (event) => {
    if (event.buttons !== 1) return;
    const box = stack.getBoundingClientRect();
    input.value = 100 * (event.clientX - box.left) / box.width;
    show();
  };
  stack.addEventListener("pointerdown", drag);
  stack.addEventListener("pointermove", drag);
  stack.addEventListener("dragstart", (event) => event.preventDefault());
  show();
}
