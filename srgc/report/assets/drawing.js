// Where the marks of a robot are at an instant. Projections and marks are those of render/svg.py and
// render/robot_drawing.py.
const srgcDrawing = (function () {
  "use strict";
  const text = (p) => p[0].toFixed(1) + " " + p[1].toFixed(1);
  const line = (points) => (points.length ? "M" + points.map(text).join("L") : "");

  function outline(points) {
    const sorted = points.slice().sort((a, b) => a[0] - b[0] || a[1] - b[1]);
    const turn = (a, b, c) => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    const half = (list) => {
      const chain = [];
      for (const p of list) {
        while (chain.length > 1 && turn(chain[chain.length - 2], chain[chain.length - 1], p) <= 0) chain.pop();
        chain.push(p);
      }
      chain.pop();
      return chain;
    };
    return sorted.length < 3 ? sorted : half(sorted).concat(half(sorted.reverse()));
  }

  function before(list, t) {
    let low = 0, high = list.length - 2;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (list[middle] <= t) low = middle; else high = middle - 1;
    }
    return Math.max(low, 0);
  }

  function between(list, rows, t) {
    const i = before(list, t), a = rows[i], b = rows[Math.min(i + 1, rows.length - 1)];
    const width = list[i + 1] - list[i];
    const s = width > 0 ? Math.min(Math.max((t - list[i]) / width, 0), 1) : 0;
    return a.map((value, k) => value + s * (b[k] - value));
  }

  function ends(mark, a, b) {
    mark.setAttribute("x1", a[0].toFixed(1));
    mark.setAttribute("y1", a[1].toFixed(1));
    mark.setAttribute("x2", b[0].toFixed(1));
    mark.setAttribute("y2", b[1].toFixed(1));
  }

  const put = (mark, p) => mark.setAttribute("transform", "translate(" + text(p) + ")");

  function marksOf(group) {
    const all = (name) => (group ? Array.from(group.querySelectorAll("." + name)) : []);
    return {
      foot: all("foot")[0], bones: all("bone"), rods: all("rod"), capsules: all("capsule"), solids: all("solid"),
      axes: all("axis"), joints: all("joint"), masses: all("mass"), effectors: all("effector"),
    };
  }

  // `at` gives the place in the picture of a point by its number; `room` is what the numbers of effectors keep off.
  function robot(marks, motion, at, room) {
    if (marks.foot) put(marks.foot, at(0));
    motion.bones.forEach(([a, b], i) => ends(marks.bones[i], at(a), at(b)));
    motion.solids.forEach((corners, i) => marks.solids[i].setAttribute("d", line(outline(corners.map(at))) + "Z"));
    let capsule = 0;
    motion.rods.forEach(([a, b, thick], i) => {
      ends(marks.rods[i], at(a), at(b));
      if (thick) ends(marks.capsules[capsule++], at(a), at(b));
    });
    let axis = 0;
    motion.joints.forEach(([point, tip], i) => {
      const foot = at(point);
      put(marks.joints[i], foot);
      if (tip < 0) return;
      const end = at(tip), x = end[0] - foot[0], y = end[1] - foot[1];
      const part = Math.min(17 / Math.max(Math.hypot(x, y), 1e-9), 1);
      ends(marks.axes[axis++], [foot[0] - part * x, foot[1] - part * y], [foot[0] + part * x, foot[1] + part * y]);
    });
    motion.masses.forEach((point, i) => put(marks.masses[i], at(point)));
    const tips = motion.effectors.map((point) => at(point));
    tips.forEach((tip, i) => put(marks.effectors[i], tip));
    srgcNumbers.show(marks.effectors, tips, room);
  }

  return { text: text, line: line, outline: outline, before: before, between: between, marksOf: marksOf, robot: robot };
})();
