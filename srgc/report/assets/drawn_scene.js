// A workspace, and where there is one a robot in motion in it: moves the marks that the page shows.
// `holder` has what is read of the motion.
const srgcScene = function (data, picture, holder) {
  "use strict";
  const drawn = srgcDrawing, line = drawn.line, outline = drawn.outline, text = drawn.text;
  const before = drawn.before, between = drawn.between;
  const d = data.dimension;
  const grid = data.unit * data.scale;
  const motion = data.motion || null;
  const all = (selector) => Array.from(picture.querySelectorAll(selector));
  let axes = data.axes, zoom = 1;

  // --- projection ---

  function seen(row, at) {
    let x = 0, y = 0;
    for (let i = 0; i < d; i++) {
      x += axes[0][i] * row[at + i];
      y += axes[1][i] * row[at + i];
    }
    return [data.width / 2 + zoom * grid * x, data.height / 2 - zoom * grid * y];
  }

  function box(low, high, at) {
    const corners = [];
    for (let bits = 0; bits < 1 << d; bits++) {
      const corner = [];
      for (let i = 0; i < d; i++) corner.push((bits >> i) & 1 ? high[at + i] : low[at + i]);
      corners.push(seen(corner, 0));
    }
    return line(outline(corners)) + "Z";
  }

  // --- the sets of the workspace, which only a view of space changes ---

  function drawShapes() {
    if (d !== 3) return;
    const outlines = new Map();
    all(".shape").forEach((mark, index) => {
      const shape = data.shapes[index], corners = [];
      for (let i = 0; i < shape.corners.length; i += 3) corners.push(seen(shape.corners, i));
      mark.querySelector(".face").setAttribute("d", line(outline(corners)) + "Z");
      let edges = "";
      for (let i = 0; i < shape.edges.length; i += 2) {
        edges += line([corners[shape.edges[i]], corners[shape.edges[i + 1]]]);
      }
      mark.querySelector(".edges").setAttribute("d", edges);
      outlines.set(index, corners);
    });
    all(".names").forEach((group) => drawNames(group, outlines));
    all(".triad path").forEach((mark, i) => {
      mark.setAttribute("d", "M0 0L" + text([34 * axes[0][i], -34 * axes[1][i]]));
    });
    all(".triad text").forEach((mark, i) => {
      mark.setAttribute("x", (44 * axes[0][i]).toFixed(1));
      mark.setAttribute("y", (-44 * axes[1][i]).toFixed(1));
    });
  }

  // The names of a group have one size; there is another group for phones.
  function drawNames(group, outlines) {
    const texts = Array.from(group.querySelectorAll("text"));
    const labels = texts.map((mark) => {
      const corners = outlines.get(Number(mark.dataset.shape));
      const half = mark.dataset.half.split(" ").map(Number);
      const low = [0, 1].map((i) => Math.min(...corners.map((c) => c[i])));
      const high = [0, 1].map((i) => Math.max(...corners.map((c) => c[i])));
      const at = [0, 1].map((i) => (low[i] + high[i]) / 2), size = [0, 1].map((i) => high[i] - low[i]);
      const fits = size[0] > 2 * half[0] + 8 && size[1] > 2 * half[1] + 5;
      const reach = fits ? [0, 0] : [Math.min(size[0] / 2, half[0]), size[1] / 2];
      return { at: at, half: half, reach: reach, home: fits ? at : null };
    });
    const triad = { at: [52, data.height - 52], half: [52, 52] };
    srgcLabels.placed(labels, [data.width, data.height], [triad]).forEach((middle, i) => {
      const mark = texts[i], end = middle && srgcLabels.end(labels[i], middle);
      mark.previousElementSibling.setAttribute("d", end ? line([labels[i].at, end]) : "");
      mark.setAttribute("visibility", middle ? "visible" : "hidden");
      if (!middle) return;
      mark.setAttribute("x", middle[0].toFixed(1));
      // Letters stand 0.36 of their size below the middle of a line that is 1.25 of it high.
      mark.setAttribute("y", (middle[1] + 0.576 * labels[i].half[1]).toFixed(1));
    });
  }

  function turned(newAxes, newZoom) {
    axes = newAxes;
    zoom = newZoom;
    drawShapes();
  }

  if (!motion) return { motion: null, turned: turned };

  // --- the motion ---

  const times = motion.times, end = motion.steps * motion.step;
  const marks = {
    ...drawn.marksOf(picture.querySelector(".robot")), trails: all(".trail"), traces: all(".trace"),
    cells: all(".cell"), tube: all(".tube")[0], ribbon: all(".ribbon")[0],
    now: all(".tube-now")[0], instant: all(".instant")[0],
  };
  const readings = {
    time: holder.querySelector(".readings .time"), sample: holder.querySelector(".readings .sample"),
    cells: Array.from(holder.querySelectorAll(".readings .cell")),
    q: Array.from(holder.querySelectorAll(".readings .q")),
  };
  let tips = [], now = 0;

  let room = null;
  function measured() { room = srgcNumbers.room(picture, [data.width, data.height], d); }
  const drawRobot = (row) => drawn.robot(marks, motion, (point) => seen(row, point * d), room);

  function drawTraces(row, t) {
    const i = before(times, t);
    motion.effectors.forEach((point, e) => {
      const way = tips[e].slice(0, i + 1);
      way.push(seen(row, point * d));
      marks.traces[e].setAttribute("d", line(way));
    });
  }

  function instantBoxes(row, t) {
    const tube = motion.tube, half = between(tube.instants, tube.half, t);
    const wide = data.factor / data.unit;
    return motion.effectors.map((point, e) => {
      const low = [], high = [];
      for (let i = 0; i < d; i++) {
        low.push(row[point * d + i] - wide * half[e * d + i]);
        high.push(row[point * d + i] + wide * half[e * d + i]);
      }
      return box(low, high, 0);
    }).join("");
  }

  function drawTube(row, t) {
    const tube = motion.tube;
    if (!tube) return;
    const i = Math.min(before(tube.times, t), tube.low.length - 1);
    marks.now.setAttribute("d", motion.effectors.map((_, e) => box(tube.low[i], tube.high[i], e * d)).join(""));
    marks.instant.setAttribute("d", instantBoxes(row, t));
  }

  function read(t) {
    const sample = Math.min(Math.floor(t / motion.step + 1e-6), motion.steps);
    const here = motion.visits.map((visits) => {
      let cell = -1;
      for (const [since, index] of visits) if (since <= sample) cell = index;
      return cell;
    });
    marks.cells.forEach((mark, index) => mark.classList.toggle("here", here.includes(index)));
    readings.cells.forEach((mark, e) => { srgcWrite(mark, here[e] < 0 ? "" : motion.cells[here[e]]); });
    readings.time.textContent = shortTime(t) + " s";
    readings.sample.textContent = String(sample);
    between(times, motion.q, t).forEach((value, i) => {
      const turns = motion.kinds[i] === "revolute";
      readings.q[i].textContent = turns ? (value * 180 / Math.PI).toFixed(1) + "°" : short(value, 4) + " m";
    });
  }

  const short = (value, digits) => String(Number(value.toPrecision(digits)));
  // As fine as a thousandth of a step, and no finer than a millisecond where steps are long.
  const decimals = Math.min(Math.max(Math.ceil(1 - Math.log10(motion.step)), 3), 12);
  const shortTime = (t) => String(Number(t.toFixed(decimals)));

  function draw() {
    const row = between(times, motion.points, now);
    drawRobot(row);
    drawTraces(row, now);
    drawTube(row, now);
  }

  const thick = marks.capsules.concat(marks.solids);
  const widths = thick.map((mark) => Number(mark.getAttribute("stroke-width")));

  function turnedRobot(newAxes, newZoom) {
    turned(newAxes, newZoom);
    measured();
    thick.forEach((mark, i) => mark.setAttribute("stroke-width", (zoom * widths[i]).toFixed(1)));
    tips = motion.effectors.map((point) => motion.points.map((row) => seen(row, point * d)));
    if (d === 3) {
      marks.trails.forEach((mark, e) => mark.setAttribute("d", line(tips[e])));
      if (motion.tube) {
        marks.tube.setAttribute("d", motion.tube.low.map((low, i) =>
          motion.effectors.map((_, e) => box(low, motion.tube.high[i], e * d)).join("")).join(""));
      }
    }
    if (motion.tube) {
      marks.ribbon.setAttribute("d", motion.tube.instants.map((t) =>
        instantBoxes(between(times, motion.points, t), t)).join(""));
    }
    draw();
  }

  turnedRobot(axes, zoom);
  window.addEventListener("resize", () => { measured(); draw(); });
  return {
    motion: motion, end: end, turned: turnedRobot, shortTime: shortTime,
    show: (t) => { now = Math.min(Math.max(t, 0), end); draw(); read(now); return now; },
  };
};
