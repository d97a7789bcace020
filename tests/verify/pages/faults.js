// A function that says what is wrong with a page as it is drawn now, a sentence for each fault.
// Its argument has sizes in CSS pixels: the least of text of the page and of text in figures, the largest of both.
(({ html, figure, largest }) => {
  const found = [];
  const root = document.scrollingElement || document.documentElement;
  for (const one of document.querySelectorAll("details")) one.open = true;
  const UNSEEN = "script, style, noscript, template, title, option, defs, clipPath, mask, marker, pattern, symbol";
  const seen = (node) => !node.closest(UNSEEN) && node.checkVisibility({ opacityProperty: true, visibilityProperty: true });
  const words = (text) => text.trim().replace(/\s+/g, " ").slice(0, 60);
  const where = (node) => {
    const named = node.closest("svg[aria-labelledby], section[id], [class]");
    return `in ${named?.querySelector(":scope > title")?.textContent || named?.id || named?.getAttribute("class") || "the page"}`;
  };

  // Nothing is wider than the page; a picture on its own has its own width.
  if (document.body && root.scrollWidth > innerWidth + 1) found.push(`page: ${root.scrollWidth} px wide in a window of ${innerWidth} px`);

  // What no style says is painted black.
  const BLACK = "rgb(0, 0, 0)";
  const black = new Map();
  for (const node of document.querySelectorAll("svg path, svg line, svg rect, svg circle, svg ellipse, svg polygon, svg polyline, svg text, svg tspan, svg use")) {
    if (!seen(node)) continue;
    const { fill, fillOpacity, stroke, strokeOpacity, strokeWidth } = getComputedStyle(node), box = node.getBBox();
    const filled = fill === BLACK && fillOpacity > 0 && box.width * box.height > 0 && node.tagName !== "line";
    const drawn = stroke === BLACK && strokeOpacity > 0 && parseFloat(strokeWidth) > 0;
    if (filled || drawn) black.set(where(node), [...(black.get(where(node)) || []), node.tagName]);
  }
  for (const [place, tags] of black) found.push(`black: ${tags.length} times (${[...new Set(tags)].join(", ")}) ${place}`);

  // A figure that is there is drawn.
  for (const svg of document.querySelectorAll("svg")) {
    const shown = seen(svg) ? [...svg.querySelectorAll("path, line, rect, circle, image, text")].filter(seen) : [null];
    const box = svg.getBoundingClientRect();
    if (!shown.length || (seen(svg) && box.width * box.height < 1)) found.push(`empty: a figure ${where(svg)}`);
  }

  // Every text: where it is seen, how large, in which colour on which ground.
  const canvas = new OffscreenCanvas(1, 1).getContext("2d", { willReadFrequently: true });
  const over = (colour, ground) => {
    canvas.fillStyle = `rgb(${ground})`; canvas.fillRect(0, 0, 1, 1);
    canvas.fillStyle = colour; canvas.fillRect(0, 0, 1, 1);
    return [...canvas.getImageData(0, 0, 1, 1).data].slice(0, 3);
  };
  const luminance = (rgb) => {
    const [r, g, b] = rgb.map((v) => v / 255).map((v) => (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const ground = (node) => over(getComputedStyle(node).backgroundColor, node.parentElement ? ground(node.parentElement) : [255, 255, 255]);
  const clipped = (rect, node) => {
    let [x0, y0, x1, y1] = [rect.left, rect.top, rect.right, rect.bottom];
    for (let up = node; up; up = up.parentElement) {
      if (up === root || up === document.body || getComputedStyle(up).overflowX === "visible") continue;
      const box = up.getBoundingClientRect();
      [x0, y0, x1, y1] = [Math.max(x0, box.left), Math.max(y0, box.top), Math.min(x1, box.right), Math.min(y1, box.bottom)];
    }
    return { x0, y0, x1, y1 };
  };
  const boxes = [];
  for (const walker = document.createTreeWalker(document, NodeFilter.SHOW_TEXT); walker.nextNode();) {
    const text = walker.currentNode, node = text.parentElement;
    if (!text.textContent.trim() || !node || !seen(node)) continue;
    const svg = node.closest("svg"), style = getComputedStyle(node), said = words(text.textContent);
    const range = document.createRange();
    range.selectNodeContents(text);
    const whole = [...range.getClientRects()].filter((rect) => rect.width > 0 && rect.right > 0);
    if (!whole.length) continue;

    const turn = svg ? node.getScreenCTM() : null;
    const size = parseFloat(style.fontSize) * (turn ? Math.hypot(turn.a, turn.b) : 1), least = svg ? figure : html;
    if (size < least - 0.05 || size > largest) found.push(`size: ${size.toFixed(1)} px of "${said}" ${where(node)}`);

    const behind = ground(svg || node), colour = svg ? style.fill : style.color, painted = over(colour, behind);
    const [a, b] = [luminance(painted), luminance(behind)].sort((x, y) => y - x);
    if (colour === BLACK) found.push(`black: "${said}" ${where(node)}`);
    else if ((a + 0.05) / (b + 0.05) < 4.5) found.push(`contrast: "${said}" ${painted} on ${behind} ${where(node)}`);

    if (svg) {
      const box = svg.getBoundingClientRect();
      const out = Math.max(...whole.map((r) => Math.max(box.left - r.left, r.right - box.right, box.top - r.top, r.bottom - box.bottom)));
      if (out > 1) found.push(`outside: "${said}" by ${out.toFixed(1)} px ${where(node)}`);
    }
    // The middle of a line is what its letters fill; lines that stand close share the rest.
    const upright = !turn || Math.abs(turn.b) < 0.1 * Math.abs(turn.a);
    for (const rect of whole) {
      const one = clipped(rect, node), [x, y] = upright ? [0.5, 0.2 * rect.height] : [0.2 * rect.width, 0.5];
      const box = { x0: one.x0 + x, x1: one.x1 - x, y0: one.y0 + y, y1: one.y1 - y, said, node };
      if (box.x1 - box.x0 > 1 && box.y1 - box.y0 > 1) boxes.push(box);
    }
  }

  if (!boxes.length) found.push("empty: no text is seen");

  // No text on another one.
  boxes.sort((a, b) => a.y0 - b.y0);
  let open = [];
  for (const box of boxes) {
    open = open.filter((one) => one.y1 > box.y0 + 1);
    for (const one of open) {
      const [w, h] = [Math.min(one.x1, box.x1) - Math.max(one.x0, box.x0), Math.min(one.y1, box.y1) - box.y0];
      if (w > 1 && h > 1 && one.node !== box.node)
        found.push(`overlap: "${one.said}" and "${box.said}" by ${w.toFixed(0)} x ${h.toFixed(0)} px ${where(box.node)}`);
    }
    open.push(box);
  }
  return found;
})
