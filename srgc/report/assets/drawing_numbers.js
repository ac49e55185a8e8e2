// Where the numbers of effectors stand, as render/effector_numbers.py has it: on discs beside them, off the names
// of regions, off all effectors and off each other.
const srgcNumbers = (function () {
  "use strict";
  const HALF = 8, NARROW_HALF = 14, RING = 8, GAP = 2, NEAR = 10;
  const FARTHER = [0, 10, 22, 38, 58, 84, 120, 170, 240, 340];
  const TURNS = [0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6, -6, 7, -7, 8];

  function places(point, half) {
    return FARTHER.flatMap((more) => TURNS.map((turn) => {
      const radius = RING + half + GAP + more, angle = Math.PI * (turn / 8 - 1 / 4);
      return [point[0] + radius * Math.cos(angle), point[1] + radius * Math.sin(angle)];
    }));
  }

  // `kept` has middles `at` and halves `half` of rectangles.
  function placed(points, size, kept, half) {
    const found = [];
    const off = (m, other, reach) => Math.hypot(m[0] - other[0], m[1] - other[1]) > reach + GAP / 2;
    const free = (m) => [0, 1].every((i) => m[i] >= half && m[i] <= size[i] - half) &&
      kept.every((other) => [0, 1].some((i) => Math.abs(m[i] - other.at[i]) >= half + other.half[i] + GAP)) &&
      points.every((other) => off(m, other, half + RING)) && found.every((other) => off(m, other, 2 * half));
    points.forEach((point) => {
      const all = places(point, half);
      found.push(all.find(free) || all[0]);
    });
    return found;
  }

  // What the numbers keep off in a picture: the names that it shows, and the scale or the axes in its corner.
  function room(picture, size, dimension) {
    const groups = Array.from(picture.querySelectorAll(".names"));
    const names = groups.find((group) => getComputedStyle(group).display !== "none");
    const narrow = Boolean(names) && names.classList.contains("narrow");
    const wide = dimension === 3 ? [104, 104] : [0.25 * size[0] + 24, 40];
    const kept = [{ at: [wide[0] / 2, size[1] - wide[1] / 2], half: [wide[0] / 2, wide[1] / 2] }];
    for (const mark of names ? names.querySelectorAll("text") : []) {
      if (mark.getAttribute("visibility") === "hidden") continue;
      const half = mark.dataset.half.split(" ").map(Number);
      // Letters stand 0.36 of their size below the middle of a line that is 1.25 of it high.
      const at = [Number(mark.getAttribute("x")), Number(mark.getAttribute("y")) - 0.576 * half[1]];
      kept.push({ at: at, half: half });
    }
    return { size: size, kept: kept, half: narrow ? NARROW_HALF : HALF };
  }

  function show(marks, points, room) {
    if (points.length < 2) return;
    placed(points, room.size, room.kept, room.half).forEach((found, i) => {
      const way = [found[0] - points[i][0], found[1] - points[i][1]], distance = Math.hypot(way[0], way[1]);
      const far = distance > RING + NARROW_HALF + GAP + NEAR, part = RING / distance;
      const text = (p) => p[0].toFixed(1) + " " + p[1].toFixed(1);
      marks[i].querySelector(".number").setAttribute("transform", "translate(" + text(way) + ")");
      marks[i].querySelector(".leader").setAttribute(
        "d", far ? "M" + text([part * way[0], part * way[1]]) + "L" + text(way) : "");
    });
  }

  return { room: room, show: show };
})();
