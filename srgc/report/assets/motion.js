// The motions of a report, one after the other: what plays them, and what turns space.
(function () {
  "use strict";
  const root = document.getElementById("motion");
  const source = document.getElementById("motion-data");
  if (!root || !source) return;
  const content = JSON.parse(source.textContent);
  const list = Array.isArray(content) ? content : [content];
  const pictures = Array.from(root.querySelectorAll(":scope > figure > .scene, :scope > figure > .part > .scene"));
  const parts = Array.from(root.querySelectorAll(":scope > figure > .part"));
  const said = Array.from(root.querySelectorAll(":scope > figure > .said"));
  const scenes = list.map((data, i) => srgcScene(data, pictures[i], said[i] || root));
  const HOLD = 900;  // milliseconds that the end of a motion is seen before the next one begins

  if (scenes[0].motion) play();

  function play() {
    const slider = root.querySelector("input[type=range]");
    const button = root.querySelector(".play");
    const speed = root.querySelector(".speed select");
    const jumps = Array.from(root.querySelectorAll("[data-part]"));
    const calm = window.matchMedia("(prefers-reduced-motion: reduce)");
    const steps = scenes.map((scene) => scene.motion.steps);
    // The slider has every sample of every motion: the last of one is not the first of the next.
    const first = steps.map((_, i) => steps.slice(0, i).reduce((sum, each) => sum + each + 1, 0));
    let part = 0, now = 0, frame = 0, last = 0, shown = 0, held = 0;
    const ended = () => now >= scenes[part].end;

    function show(index, t) {
      part = index;
      for (const list of [parts, said]) list.forEach((each, i) => { each.hidden = i !== part; });
      now = scenes[part].show(t);
      const sample = Math.min(Math.round(now / scenes[part].motion.step), steps[part]);
      const task = parts.length ? parts[part].dataset.task + ", " : "";
      slider.value = String(first[part] + sample);
      slider.setAttribute("aria-valuetext", task + scenes[part].shortTime(now) + " s");
      jumps.forEach((jump) => jump.setAttribute("aria-pressed", String(Number(jump.dataset.part) === part)));
      document.dispatchEvent(new CustomEvent("srgc-time", { detail: { t: now, part: part } }));
    }

    function toSample(value) {
      let index = 0;
      while (index + 1 < first.length && value >= first[index + 1]) index += 1;
      show(index, (value - first[index]) * scenes[index].motion.step);
    }

    function stop() {
      cancelAnimationFrame(frame);
      frame = 0;
      button.textContent = "▶";
      button.setAttribute("aria-label", "Play");
    }

    function advance(instant) {
      if (!ended()) {
        show(part, now + (instant - last) / 1000 * Number(speed.value));
        held = instant;
      } else if (instant - held > HOLD) {
        show(part + 1, 0);
      }
      last = instant;
    }

    function tick(instant) {
      // Few pictures a second for those who asked for little motion.
      if (!calm.matches || instant - shown > 700) {
        shown = instant;
        advance(instant);
      }
      if (ended() && part === scenes.length - 1) stop(); else frame = requestAnimationFrame(tick);
    }

    button.addEventListener("click", () => {
      if (frame) { stop(); return; }
      if (ended() && part === scenes.length - 1) show(0, 0);
      button.textContent = "❚❚";
      button.setAttribute("aria-label", "Pause");
      last = shown = held = performance.now();
      frame = requestAnimationFrame(tick);
    });
    slider.addEventListener("input", () => { stop(); toSample(Number(slider.value)); });
    jumps.forEach((jump) => jump.addEventListener("click", () => { stop(); show(Number(jump.dataset.part), 0); }));
    document.addEventListener("srgc-seek", (event) => {
      const t = event.detail ? Number(event.detail.t) : NaN;
      if (Number.isFinite(t)) { stop(); show(part, t); }
    });
    root.querySelectorAll("[data-show]").forEach((mark) => {
      const apply = () => pictures.forEach((each) => each.classList.toggle("hide-" + mark.dataset.show, !mark.checked));
      mark.addEventListener("change", apply);
      apply();
    });
    root.querySelector(".controls").hidden = false;
    show(0, 0);
  }

  // --- views of space, the same for all motions ---

  function turnable() {
    const bar = root.querySelector(".views");
    const views = list[0].views;
    const buttons = Array.from(bar.querySelectorAll("[data-view]"));
    let azimuth = views[0][1], elevation = views[0][2], zoom = 1, hold = null;

    function turn(a, e, chosen) {
      azimuth = a;
      elevation = Math.min(Math.max(e, -Math.PI / 2), Math.PI / 2);
      const ca = Math.cos(a), sa = Math.sin(a), ce = Math.cos(elevation), se = Math.sin(elevation);
      const axes = [[ca, sa, 0], [-sa * se, ca * se, ce]];
      buttons.forEach((button, i) => button.setAttribute("aria-pressed", String(i === chosen)));
      scenes.forEach((scene) => scene.turned(axes, zoom));
    }

    buttons.forEach((button, i) => {
      button.addEventListener("click", () => turn(views[i][1], views[i][2], i));
    });
    bar.querySelectorAll("[data-zoom]").forEach((button) => {
      button.addEventListener("click", () => {
        zoom = Math.min(Math.max(zoom * Number(button.dataset.zoom), 0.1), 10);
        turn(azimuth, elevation, buttons.findIndex((each) => each.getAttribute("aria-pressed") === "true"));
      });
    });
    pictures.forEach((picture) => {
      picture.addEventListener("pointerdown", (event) => {
        hold = [event.clientX, event.clientY, azimuth, elevation];
        picture.setPointerCapture(event.pointerId);
      });
      picture.addEventListener("pointermove", (event) => {
        if (hold) turn(hold[2] - (event.clientX - hold[0]) / 150, hold[3] + (event.clientY - hold[1]) / 150, -1);
      });
      ["pointerup", "pointercancel"].forEach((name) => picture.addEventListener(name, () => { hold = null; }));
      picture.addEventListener("keydown", (event) => {
        const step = { ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key];
        if (!step) return;
        event.preventDefault();
        turn(azimuth + step[0], elevation + step[1], -1);
      });
      picture.classList.add("turning");
    });
    bar.hidden = false;
    turn(azimuth, elevation, 0);
  }

  if (list[0].dimension === 3) turnable();
  root.classList.add("live");
})();
