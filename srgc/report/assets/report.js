"use strict";
(function () {
  const holder = document.getElementById("chart-data");
  const data = holder ? JSON.parse(holder.textContent) : {};
  const charts = Array.from(document.querySelectorAll("svg.chart[data-name]"));
  const outputs = new Map();
  for (const output of document.querySelectorAll("output[data-for]")) {
    outputs.set(output.dataset.for, output);
  }

  function valueAt(curve, t) {
    const times = curve.t;
    let low = 0;
    let high = times.length - 1;
    // The times have six digits: a step begins no later than a sample that is rounded down.
    if (curve.held) { t += 0.01 * (times[high] - times[0]) / high; }
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] <= t) { low = middle; } else { high = middle; }
    }
    if (curve.held) { return curve.v[t >= times[high] ? Math.min(high, curve.v.length - 1) : low]; }
    const part = Math.min(Math.max((t - times[low]) / (times[high] - times[low]), 0), 1);
    return curve.v[low] + part * (curve.v[high] - curve.v[low]);
  }

  function shown(curve, value) {
    const short = String(Number(value.toPrecision(4)));
    return curve.turns ? short + " (" + (value * 180 / Math.PI).toFixed(1) + "°)" : short;
  }

  function show(t) {
    for (const chart of charts) {
      const d = chart.dataset;
      const part = Math.min(Math.max((t - d.t0) / (d.t1 - d.t0), 0), 1);
      const x = Number(d.x0) + part * (d.x1 - d.x0);
      chart.querySelector(".cursor").setAttribute("transform", "translate(" + x.toFixed(2) + " 0)");
      const output = outputs.get(d.name);
      if (output) { output.textContent = shown(data[d.name], valueAt(data[d.name], t)); }
    }
  }

  function seek(t) {
    document.dispatchEvent(new CustomEvent("srgc-seek", { detail: { t: t } }));
  }

  function timeAt(chart, event) {
    const box = chart.getBoundingClientRect();
    const d = chart.dataset;
    const x = (event.clientX - box.left) / box.width * chart.viewBox.baseVal.width;
    const part = Math.min(Math.max((x - d.x0) / (d.x1 - d.x0), 0), 1);
    return Number(d.t0) + part * (d.t1 - d.t0);
  }

  for (const chart of charts) {
    chart.addEventListener("click", (event) => seek(timeAt(chart, event)));
    chart.addEventListener("pointermove", (event) => {
      if (event.buttons & 1) { seek(timeAt(chart, event)); }
    });
  }
  for (const button of document.querySelectorAll("button[data-seek]")) {
    button.addEventListener("click", () => {
      seek(Number(button.dataset.seek));
      const motion = document.getElementById("motion");
      if (motion) { motion.scrollIntoView({ block: "start" }); }
    });
  }
  document.addEventListener("srgc-time", (event) => show(event.detail.t));
  if (charts.length) { show(Number(charts[0].dataset.t0)); }
})();
// What scrolls inside the page is a stop of the tab key, so that it can be scrolled without a pointer.
(function () {
  "use strict";
  const regions = Array.from(document.querySelectorAll(".scroll, pre"));
  const mark = (each) => {
    if (each.scrollWidth > each.clientWidth) each.tabIndex = 0; else each.removeAttribute("tabindex");
  };
  const all = () => regions.forEach(mark);
  window.addEventListener("resize", all);
  document.addEventListener("toggle", all, true);
  all();
})();
