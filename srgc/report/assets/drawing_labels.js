// Where labels stand, as render/label_placement.py has it: on or beside what they name, within the picture,
// and never on each other. A label has `at`, the point that it names; `half` of its size; `reach`, half of what
// is named; and, where it has room there, its `home`. Its place is null where none is free.
const srgcLabels = (function () {
  "use strict";
  const GAP = 2, RINGS = [4, 12, 24, 40, 60], DIRECTIONS = 16, NEAR = 12;

  const off = (label, m) => Math.hypot(...[0, 1].map((i) =>
    Math.max(Math.abs(m[i] - label.at[i]) - label.half[i] - label.reach[i], 0)));

  function rings(label) {
    const found = [];
    for (const ring of RINGS) {
      for (let k = 0; k < DIRECTIONS; k++) {
        const angle = 2 * Math.PI * (k - DIRECTIONS / 4) / DIRECTIONS;
        const way = [Math.cos(angle), Math.sin(angle)];
        const scale = Math.min(...[0, 1].map((i) =>
          1 / Math.max(Math.abs(way[i]) / (label.half[i] + label.reach[i]), 1e-9)));
        found.push([0, 1].map((i) => label.at[i] + way[i] * (scale + ring)));
      }
    }
    return found;
  }

  function grid(half, size) {
    const found = [];
    for (let x = half[0]; x <= size[0] - half[0]; x += half[0]) {
      for (let y = half[1]; y <= size[1] - half[1]; y += half[1]) found.push([x, y]);
    }
    return found;
  }

  // `kept` is what labels keep off: middles `at` and halves `half` of rectangles.
  function placed(labels, size, kept) {
    const taken = kept.slice();
    const inside = (p, half) => [0, 1].every((i) => p[i] >= half[i] && p[i] <= size[i] - half[i]);
    const free = (m, half) => inside(m, half) && taken.every((other) =>
      [0, 1].some((i) => Math.abs(m[i] - other.at[i]) >= half[i] + other.half[i] + GAP));

    function place(label) {
      if (!inside(label.at, [0, 0])) return null;
      if (label.home && free(label.home, label.half)) return label.home;
      for (const candidates of [rings, () => grid(label.half, size)]) {
        const open = candidates(label).filter((m) => free(m, label.half));
        if (open.length) return open.reduce((best, m) => (off(label, m) < off(label, best) ? m : best));
      }
      return null;
    }

    // Names that have room stay in their regions, whatever the others are.
    const places = labels.map(() => null);
    for (const first of [true, false]) {
      labels.forEach((label, i) => {
        if (Boolean(label.home) !== first) return;
        places[i] = place(label);
        if (places[i]) taken.push({ at: places[i], half: label.half });
      });
    }
    return places;
  }

  // The end at the label of the line to it, or null where the label is near.
  function end(label, middle) {
    if (off(label, middle) < NEAR) return null;
    return [0, 1].map((i) => Math.min(Math.max(label.at[i], middle[i] - label.half[i]), middle[i] + label.half[i]));
  }

  return { placed: placed, end: end };
})();
