// The work-precision charts: each draws the rows that the page carries with it, on any two of their quantities.
for (const whole of document.querySelectorAll(".work-precision")) {
  const data = JSON.parse(whole.querySelector(".rows").textContent);
  const [chart, note, across, up] = [".chart", ".point-said", ".across", ".up"].map((name) => whole.querySelector(name));
  const hidden = new Set(), L = 64, B = 44, T = 12, R = 16;
  let W = 760, H = 420;
  const make = (name, attributes, parent, text) => {
    const node = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    if (text !== undefined) node.textContent = text;
    parent.append(node);
    return node;
  };
  const shapes = {
    0: "M0-6L2-2L6-2L3 1L4 6L0 3L-4 6L-3 1L-6-2L-2-2Z", 1: "M-5-4L5-4L0 5Z", 2: "M-4-4L4-4L4 4L-4 4Z",
    3: "M-4.5 0A4.5 4.5 0 1 0 4.5 0A4.5 4.5 0 1 0-4.5 0Z", 4: "M0-5.5L5.5 0L0 5.5L-5.5 0Z", 5: "M-5-2L-2-2L-2-5L2-5L2-2L5-2L5 2L2 2L2 5L-2 5L-2 2L-5 2Z",
  };
  const short = (x) => (x >= 1e4 || x < 1e-3 ? x.toExponential(0) : String(Number(x.toPrecision(3))));
  const scale = (values, from, to) => {
    const [low, high] = [Math.min(...values) / 1.2, Math.max(...values) * 1.2].map(Math.log10);
    const at = (v) => from + ((Math.log10(v) - low) / (high - low || 1)) * (to - from);
    const ticks = [], steps = Math.abs(to - from) < 110 * (high - low) ? [1] : [1, 2, 5];
    for (let e = Math.floor(low); e <= high; e++)
      for (const m of steps) if (Math.log10(m) + e >= low && Math.log10(m) + e <= high) ticks.push(m * 10 ** e);
    return { at, ticks };
  };
  const draw = () => {
    [W, H] = chart.clientWidth > 0 ? [Math.max(300, Math.min(760, chart.clientWidth)), chart.clientWidth < 560 ? 340 : 420] : [W, H];
    chart.setAttribute("viewBox", `0 0 ${W} ${H}`);
    chart.replaceChildren();
    const value = (row, axis) => row[axis.value] * (axis.selectedOptions[0].dataset.scale || 1);
    const shown = data.rows.filter((row) => !hidden.has(row.method) && value(row, across) > 0 && value(row, up) > 0);
    if (!shown.length) return;
    const x = scale(shown.map((row) => value(row, across)), L, W - R), y = scale(shown.map((row) => value(row, up)), H - B, T);
    for (const tick of x.ticks) {
      make("line", { x1: x.at(tick), x2: x.at(tick), y1: T, y2: H - B, stroke: "var(--rule)", "stroke-width": 0.6 }, chart);
      make("text", { x: x.at(tick), y: H - B + 16, "text-anchor": "middle", fill: "var(--muted)", "font-size": 11 }, chart, short(tick));
    }
    for (const tick of y.ticks) {
      make("line", { x1: L, x2: W - R, y1: y.at(tick), y2: y.at(tick), stroke: "var(--rule)", "stroke-width": 0.6 }, chart);
      make("text", { x: L - 6, y: y.at(tick) + 4, "text-anchor": "end", fill: "var(--muted)", "font-size": 11 }, chart, short(tick));
    }
    make("text", { x: (L + W - R) / 2, y: H - 8, "text-anchor": "middle", fill: "var(--ink)", "font-size": 12 }, chart, across.selectedOptions[0].text);
    const turn = `rotate(-90 14 ${(T + H - B) / 2})`;
    make("text", { x: 14, y: (T + H - B) / 2, transform: turn, "text-anchor": "middle", fill: "var(--ink)", "font-size": 12 }, chart, up.selectedOptions[0].text);
    // A line a method and degree through the runs that none of its own beats in both; the others are faint.
    const fronts = new Map();
    for (const row of [...shown].sort((a, b) => value(a, across) - value(b, across))) {
      const family = `${row.method} ${row.degree}`, front = fronts.get(family) || [];
      if (!front.length || value(row, up) < value(front.at(-1), up)) fronts.set(family, [...front, row]);
    }
    for (const front of fronts.values()) {
      const path = front.map((row, i) => `${i ? "L" : "M"}${x.at(value(row, across))} ${y.at(value(row, up))}`).join("");
      make("path", { d: path, fill: "none", stroke: `var(--${data.colours[front[0].method]})`, "stroke-width": 1.4 }, chart);
    }
    const best = new Set([...fronts.values()].flat());
    for (const row of shown) {
      const place = `translate(${x.at(value(row, across))} ${y.at(value(row, up))})`;
      const point = make("path", { d: shapes[row.degree], transform: place, fill: `var(--${data.colours[row.method]})`, tabindex: 0, role: "img" }, chart);
      point.classList.add("point");
      if (!best.has(row)) point.classList.add("faint");
      make("title", {}, point, row.words);
      for (const event of ["mouseenter", "focus", "click"]) point.addEventListener(event, () => { note.textContent = row.words; });
    }
  };
  for (const box of whole.querySelectorAll("input"))
    box.addEventListener("change", () => { hidden[box.checked ? "delete" : "add"](box.value); draw(); });
  for (const axis of [across, up]) axis.addEventListener("change", draw);
  whole.querySelector(".interactive").hidden = false;
  draw();
  // Letters keep their size where the window becomes narrow: the chart is drawn anew, not scaled.
  let before = chart.clientWidth;
  new ResizeObserver(() => { if (chart.clientWidth !== before) { before = chart.clientWidth; draw(); } }).observe(chart);
}
