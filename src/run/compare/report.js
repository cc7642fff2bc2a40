"use strict";
(() => {
  const { methods, times, rows } = JSON.parse(document.getElementById("data").textContent);
  // Okabe and Ito's colours, told apart by the colour-blind; dashed the second time round
  const colors = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c6bb1", "#7f7f7f"];
  const color = (i) => colors[i % colors.length];
  const dash = (i) => ["", "5 3", "2 2"][Math.floor(i / colors.length) % 3];
  const shown = methods.map(() => true);
  const at = new Map(rows.map((r) => [r.method + "\n" + r.t, r]));
  const row = (m, k) => at.get(methods[m] + "\n" + times[k]);
  const make = (tag, attributes = {}, ...inside) => {
    const svg = ["svg", "line", "polyline", "circle", "text", "title", "g"].includes(tag);
    const e = svg ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
    for (const [k, v] of Object.entries(attributes)) e.setAttribute(k, v);
    e.append(...inside);
    return e;
  };
  const short = (v) => {
    if (v === 0) return "0";
    const a = Math.abs(v);
    if (a >= 1e5) return (v / 1e6).toPrecision(3).replace(/\.?0+$/, "") + "M";
    return a >= 100 ? v.toFixed(0) : String(Number(v.toPrecision(3)));
  };

  // keys in the table of methods
  const lines = [...document.querySelectorAll("#summary tbody tr")];
  lines.forEach((line, i) => { line.querySelector(".key").style.background = color(i); });

  // pictures of the sheet, by method and time
  const pictures = [...document.querySelectorAll("#grid tbody tr")].map((line) => {
    const found = new Map();
    for (const img of line.querySelectorAll("img")) found.set(Number(img.dataset.k), img.src);
    return found;
  });

  // side by side at one time
  const slider = document.getElementById("t");
  const now = document.getElementById("t-now");
  const cards = methods.map((name, i) => {
    const pic = make("div", { class: "pic" });
    const words = make("span");
    const caption = make("figcaption", {}, make("b", {}, name), words);
    caption.style.borderTopColor = color(i);
    document.getElementById("side").append(make("figure", { class: "card" }, pic, caption));
    return { pic, words };
  });
  const marks = [];
  const show = (k) => {
    now.textContent = "t = " + times[k];
    cards.forEach(({ pic, words }, m) => {
      const src = pictures[m] && pictures[m].get(k);
      pic.replaceChildren(src ? make("img", { src, alt: methods[m] + " at t = " + times[k] }) : "no mesh");
      const r = row(m, k);
      const parts = [];
      if (r && r.pieces != null) parts.push(r.pieces === 1 ? "1 piece" : r.pieces + " pieces");
      if (r && r.genus != null) parts.push("genus " + r.genus);
      if (r && r.volume_kept != null) parts.push("volume " + r.volume_kept.toFixed(2));
      if (r && r.min_wall_mm != null) parts.push("wall " + r.min_wall_mm.toFixed(1) + " mm");
      words.textContent = parts.join(" · ") || "–";
    });
    marks.forEach((move) => move(k));
  };

  // curves
  const charts = [
    ["Volume kept", "volume_kept", ""], ["Pieces", "pieces", "", true], ["Genus", "genus", ""],
    ["Area", "area_mm2", "mm²"], ["Thinnest wall", "min_wall_mm", "mm"], ["Step from the frame before", "step_mm", "mm"],
    ["Hausdorff distance to the first parent", "hausdorff_to_a_mm", "mm"],
    ["Hausdorff distance to the second parent", "hausdorff_to_b_mm", "mm"],
    ["Stray: farthest from the nearer parent", "stray_mm", "mm"], ["Gradient error", "gradient_error", ""],
    ["Time", "seconds", "s"], ["Peak memory", "peak_mb", "MB"],
  ];
  const W = 330, H = 190, left = 42, right = 8, top = 12, bottom = 24;
  const [t0, t1] = [times[0], times[times.length - 1]];
  const x = (t) => left + (t1 > t0 ? (t - t0) / (t1 - t0) : 0.5) * (W - left - right);
  const ticks = (lo, hi) => {
    const raw = (hi - lo) / 4, mag = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((s) => s * mag).find((s) => s >= raw * 0.999);
    const all = [];
    for (let v = Math.ceil(lo / step - 1e-9) * step; v <= hi + step * 1e-9; v += step) all.push(Number(v.toPrecision(12)));
    return all;
  };
  const draw = () => {
    const home = document.getElementById("charts");
    home.replaceChildren();
    marks.length = 0;
    for (const [title, key, unit, counts] of charts) {
      const series = methods.map((_, m) => times.map((t, k) => {
        const r = row(m, k);
        return r && r[key] != null ? [t, r[key], k] : null;
      }));
      const values = series.filter((_, m) => shown[m]).flat().filter(Boolean).map((p) => p[1]);
      if (!values.length) continue;
      // counts span decades: a scale of their logarithms, one at the bottom
      const log = counts && Math.max(...values) > 20;
      const f = log ? (v) => Math.log10(Math.max(v, 1)) : (v) => v;
      let lo = log ? 0 : Math.min(0, ...values), hi = Math.max(...values.map(f));
      if (key === "area_mm2" || key === "peak_mb") lo = Math.min(...values) * 0.95;
      if (!(hi > lo)) hi = lo + 1;
      hi += (hi - lo) * 0.04;
      const y = (v) => top + (1 - (f(v) - lo) / (hi - lo)) * (H - top - bottom);
      const svg = make("svg", { viewBox: `0 0 ${W} ${H}`, role: "img", "aria-label": `${title} over t, a line a method; the numbers are in the table of frames` });
      const levels = log ? [1, 10, 100, 1000, 10000].filter((v) => Math.log10(v) <= hi) : ticks(lo, hi);
      for (const v of levels) {
        svg.append(make("line", { class: "axis", x1: left, x2: W - right, y1: y(v), y2: y(v) }));
        svg.append(make("text", { x: left - 6, y: y(v) + 3.5, "text-anchor": "end" }, short(v)));
      }
      const every = Math.ceil(times.length / 5);
      times.forEach((t, k) => {
        if (k % every === 0 || k === times.length - 1) svg.append(make("text", { x: x(t), y: H - 8, "text-anchor": "middle" }, short(t)));
      });
      const mark = make("line", { class: "now", y1: top, y2: H - bottom });
      svg.append(mark);
      marks.push((k) => { mark.setAttribute("x1", x(times[k])); mark.setAttribute("x2", x(times[k])); });
      series.forEach((points, m) => {
        if (!shown[m]) return;
        const g = make("g");
        let run = [];
        const flush = () => {
          if (run.length > 1) g.append(make("polyline", { points: run.map((p) => x(p[0]) + "," + y(p[1])).join(" "), stroke: color(m), "stroke-dasharray": dash(m) }));
          run = [];
        };
        points.forEach((p) => { if (p) run.push(p); else flush(); });
        flush();
        for (const p of points) {
          if (p) g.append(make("circle", { cx: x(p[0]), cy: y(p[1]), r: 2.6, fill: color(m) }, make("title", {}, `${methods[m]}, t = ${p[0]}: ${short(p[1])} ${unit}`)));
        }
        svg.append(g);
      });
      const words = make("figcaption", {}, title + " ", make("small", {}, unit + (log ? "log scale" : "")));
      home.append(make("figure", { class: "chart" }, words, svg));
    }
  };
  methods.forEach((name, m) => {
    const stroke = make("svg", { viewBox: "0 0 26 10", "aria-hidden": "true" });
    stroke.append(make("line", { x1: 0, x2: 26, y1: 5, y2: 5, stroke: color(m), "stroke-width": 3, "stroke-dasharray": dash(m) }));
    const button = make("button", { type: "button", "aria-pressed": "true" }, stroke, name);
    button.addEventListener("click", () => {
      shown[m] = !shown[m];
      button.setAttribute("aria-pressed", String(shown[m]));
      draw();
      show(Number(slider.value));
    });
    document.getElementById("legend").append(make("li", {}, button));
  });
  if (times.length) {
    slider.max = times.length - 1;
    slider.value = Math.floor((times.length - 1) / 2);
    slider.addEventListener("input", () => show(Number(slider.value)));
    draw();
    show(Number(slider.value));
  }
})();
