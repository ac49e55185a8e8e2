// The front of the designs: a click on a diamond, or on a button of the table, shows the design moving.
(function () {
  "use strict";
  const root = document.getElementById("objectives");
  const source = document.getElementById("front-data");
  if (!root || !source) return;
  const data = JSON.parse(source.textContent);
  const all = (selector) => Array.from(root.querySelectorAll(selector));

  const choice = root.querySelector(".axes-choice");
  if (choice) {
    choice.hidden = false;
    choice.querySelector("select").addEventListener("change", (event) => {
      // `hidden` is a property of HTML alone, not of pictures.
      all(".front-chart").forEach((chart) => chart.toggleAttribute("hidden", chart.dataset.axes !== event.target.value));
    });
  }
  if (!data.designs.length) return;

  const PAUSE = 1.2, LONGEST = 8;
  const d = data.dimension;
  const scene = root.querySelector(".front-scene");
  const name = root.querySelector(".front-name");
  const button = root.querySelector(".front-play");
  const calm = window.matchMedia("(prefers-reduced-motion: reduce)");
  const groups = new Map(all("[data-robot]").map((group) => [Number(group.dataset.robot), group]));
  const room = srgcNumbers.room(scene, [data.width, data.height], d);
  let shown = null, marks = null, now = 0, last = 0, frame = 0;

  function seen(row, at) {
    let x = 0, y = 0;
    for (let i = 0; i < d; i++) {
      x += data.axes[0][i] * row[at + i];
      y += data.axes[1][i] * row[at + i];
    }
    return [data.width / 2 + data.grid * x, data.height / 2 - data.grid * y];
  }

  const end = () => shown.motion.steps * shown.motion.step;

  function draw() {
    const row = srgcDrawing.between(shown.motion.times, shown.motion.points, Math.min(now, end()));
    srgcDrawing.robot(marks, shown.motion, (point) => seen(row, point * d), room);
  }

  function tick(instant) {
    const speed = Math.max(end() / LONGEST, 1);
    now += (instant - last) / 1000 * speed;
    last = instant;
    if (now > end() + PAUSE * speed) now = 0;
    draw();
    frame = requestAnimationFrame(tick);
  }

  function play(on) {
    cancelAnimationFrame(frame);
    frame = 0;
    button.textContent = on ? "❚❚" : "▶";
    button.setAttribute("aria-label", on ? "Pause" : "Play");
    if (!on) return;
    last = performance.now();
    frame = requestAnimationFrame(tick);
  }

  function select(number, moving) {
    const found = data.designs.find((one) => one.structure === number);
    if (!found) return;
    shown = found;
    groups.forEach((group, each) => group.setAttribute("visibility", each === number ? "visible" : "hidden"));
    marks = srgcDrawing.marksOf(groups.get(number).querySelector(".robot"));
    all(".choice").forEach((mark) => {
      const own = Number(mark.dataset.front) === number;
      mark.classList.toggle("lit", own);
      if (mark instanceof HTMLElement) mark.setAttribute("aria-pressed", String(own));
    });
    srgcWrite(name, found.says);
    now = moving ? 0 : end();
    draw();
    play(moving);
  }

  all(".choice").forEach((mark) => {
    if (mark instanceof HTMLElement) mark.hidden = false;
    mark.addEventListener("click", () => select(Number(mark.dataset.front), !calm.matches));
  });
  button.addEventListener("click", () => {
    if (!frame && now >= end()) now = 0;
    play(!frame);
  });
  scene.hidden = false;
  const first = data.designs.some((one) => one.structure === data.chosen) ? data.chosen : data.designs[0].structure;
  select(first, false);
  root.classList.add("live");
})();
