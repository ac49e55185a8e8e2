"""Three ways of taking meshes apart, on the same meshes: volume added, pieces and seconds.

CoACD and V-HACD give hulls; these are made pieces as those of ``srgc`` are (32 corners, decimals,
grown until they hold every triangle, which is checked exactly), so that all three keep the same
promise.  Run each in turn, one mesh after another:

    python benchmarks/convex_pieces.py --packages DIR [--way cuts] [--part 1/2] [--out FILE]
    python benchmarks/convex_pieces.py --packages DIR --only "kuka_iiwa/meshes/link_[1-7].stl"

``DIR`` is the ``site-packages`` of an environment with ``pybullet`` and ``example-robot-data``,
whose meshes are not copied here: their licences differ.  Without it, only random meshes are taken.
Lines are added to the file as they come, and those that are there are not made again.
"""

from __future__ import annotations

import argparse
import json
import random
import resource
import sys
import time
from collections.abc import Callable, Iterator
from fnmatch import fnmatch
from pathlib import Path
from statistics import median

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from srgc.imports.meshes.containment import uncovered
from srgc.imports.meshes.decomposition import covering, decomposed, reference_volume
from srgc.imports.meshes.measures import measured
from srgc.imports.meshes.mesh_file import read_mesh
from srgc.imports.meshes.mesh_limits import MOST_TRIANGLES
from srgc.imports.meshes.regions import PointRegion
from srgc.imports.meshes.solids import anatomy
from tests.srgc.imports.random_meshes import bumpy_ball, open_mesh, random_mesh

SEED, LARGEST = 30, 100_000


def package_meshes(folder: Path, number: int, only: str) -> Iterator[tuple[str, object]]:
    """Meshes of packages, by a seed; of the thousand made by a generator, few."""
    files = [
        path
        for path in sorted(folder.rglob("*"))
        if path.suffix.lower() in {".stl", ".obj", ".dae"}
        and "random_urdfs" not in path.parts
        and fnmatch(path.as_posix(), f"*{only}")
    ]
    random.Random(SEED).shuffle(files)
    for path in files:
        if not number:
            return
        if path.stat().st_size > 20_000_000:
            continue
        mesh = read_mesh(path)
        if len(mesh.triangles) <= LARGEST:
            number -= 1
            yield str(path.relative_to(folder)), (mesh.vertices, mesh.triangles)


def random_meshes(number: int) -> Iterator[tuple[str, object]]:
    """Half of them closed."""
    for seed in range(number):
        yield f"random {seed}", random_mesh(seed)
        yield f"random {seed} open", open_mesh(seed)


def by_cuts(vertices, triangles):
    return decomposed(vertices, triangles).pieces


def by_coacd(vertices, triangles):
    import coacd

    coacd.set_log_level("error")
    hulls = coacd.run_coacd(coacd.Mesh(vertices, triangles), seed=SEED)
    return _held(vertices, triangles, [points for points, _ in hulls])


def by_vhacd(vertices, triangles):
    import vhacdx

    hulls = vhacdx.compute_vhacd(vertices, np.asarray(triangles, dtype=np.uint32), asyncACD=False)
    return _held(vertices, triangles, [np.asarray(points) for points, _ in hulls])


def _held(vertices, triangles, hulls):
    """The hulls as pieces, grown until they hold all."""
    regions = [PointRegion(points) for points in hulls if len(points)]
    return covering(vertices, triangles, anatomy(vertices, triangles), regions)[0]


WAYS: dict[str, Callable] = {"cuts": by_cuts, "coacd": by_coacd, "vhacd": by_vhacd}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--packages", type=Path)
    parser.add_argument("--meshes", type=int, default=50)
    parser.add_argument("--only", default="", help="those whose paths end like this pattern")
    parser.add_argument("--random", type=int, default=12)
    parser.add_argument("--way", choices=WAYS, action="append")
    parser.add_argument("--large", action="store_true", help="a mesh of 100,000 triangles, too")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--part", default="1/1", help="1/2 takes every second mesh")
    asked = parser.parse_args()
    part, parts = map(int, asked.part.split("/"))
    done = {}
    if asked.out and asked.out.exists():
        for line in asked.out.read_text().splitlines():
            row = json.loads(line)
            done[row["mesh"], row["way"]] = row
    meshes = list(random_meshes(asked.random))
    if asked.packages:
        meshes = [*package_meshes(asked.packages, asked.meshes, asked.only), *meshes]
    if asked.large:
        meshes.append(("bumpy ball", bumpy_ball(LARGEST)))
    meshes = meshes[part - 1 :: parts]
    rows = []
    for name, (vertices, triangles) in meshes:
        for way in asked.way or WAYS:
            row = done.get((name, way)) or measured_row(name, way, vertices, triangles)
            rows.append(row)
            if asked.out and (name, way) not in done:
                with asked.out.open("a") as file:
                    file.write(json.dumps(row) + "\n")
            print(
                row["mesh"][-44:], row["way"], *(f"{k} {row[k]}" for k in list(row)[2:]), flush=True
            )
    for way in asked.way or WAYS:
        print_summary(way, [row for row in rows if row["way"] == way])


def measured_row(name, way, vertices, triangles) -> dict:
    started, before = time.perf_counter(), _processor()
    try:
        pieces = WAYS[way](vertices, triangles)
    except ArithmeticError as error:
        return {"mesh": name, "way": way, "triangles": len(triangles), "failed": str(error)}
    seconds, cpu = time.perf_counter() - started, _processor() - before
    if uncovered(vertices, triangles, pieces):
        raise SystemExit(f"{name}: {way} holds not all triangles")
    parts = anatomy(vertices, triangles)
    found = measured(parts, reference_volume(parts), pieces, vertices, triangles)
    return {
        "mesh": name,
        "way": way,
        "triangles": len(triangles),
        "solids": len(parts.solids),
        "shells": len(parts.shells),
        "pieces": len(pieces),
        "added": round(100 * found.added, 3),
        "seconds": round(seconds, 2),
        "cpu": round(cpu, 2),
    }


def _processor() -> float:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def print_summary(way: str, rows: list[dict]) -> None:
    whole = [row for row in rows if "failed" not in row]
    for kind, chosen in (
        ("closed", [row for row in whole if not row["shells"]]),
        ("open in part", [row for row in whole if row["shells"]]),
        ("all", whole),
    ):
        if not chosen:
            continue
        figures = {key: [row[key] for row in chosen] for key in ("added", "pieces", "cpu")}
        under = sum(added < 10 for added in figures["added"])
        print(
            f"{way:6} {kind:13} {len(chosen):3} meshes  "
            + "  ".join(f"{k} {median(v):.2f} (most {max(v):.2f})" for k, v in figures.items())
            + f"  under 10 %: {under}"
        )
    if len(whole) < len(rows):
        print(f"{way:6} failed: {len(rows) - len(whole)}")


assert LARGEST <= MOST_TRIANGLES

if __name__ == "__main__":
    main()
