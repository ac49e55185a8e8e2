"""Maps as regions: every map of a workspace becomes obstacles named ``yard.1``, ``yard.2``, ….

Everything after the checks deals with regions only. An ``avoid`` of the map avoids all its pieces,
and a formula that names it says that the effector is in one of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache, partial
from itertools import product

from compiler.workspaces.hull import value
from compiler.workspaces.map_header import MapFault
from compiler.workspaces.pieces import Pieces, Polygon, apart, disjoint
from compiler.workspaces.polytope import Polytope, polytope_of
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code
from grammar_lang.ir.formula_parts import atoms, with_atoms

PIECE_LIMIT = 5_000
"""The most pieces that a map may have within the bounds."""


@lru_cache(maxsize=8)
def pieces_of(found: ir.ObstacleMap) -> Pieces:
    """All pieces of a map. The last few maps are cached, so that each is decoded once.

    Raises:
        MapFault: the map cannot be used.
    """
    if found.scene is not None:
        from compiler.workspaces.mesh_scene import scene_pieces

        return scene_pieces(found.scene)
    if found.image is not None:
        from compiler.workspaces.map_server import map_server_pieces

        return map_server_pieces(found.text, found.path, found.image)
    from compiler.workspaces.geojson import geojson_pieces

    return geojson_pieces(found.text)


@lru_cache(maxsize=8)
def pieces_within(found: ir.ObstacleMap, bounds: ir.Region) -> tuple[Polygon, ...]:
    """The whole pieces of a map that meet the bounds, including those that only touch them.

    An effector may be in a region at the very edge of the bounds, and formulas can say so.

    Raises:
        MapFault: the map cannot be used, or there are more than ``PIECE_LIMIT`` pieces.
    """
    area = polytope_of(bounds.shape, 2)
    every = pieces_of(found).polygons
    inside = tuple(piece for piece in every if not _outside(area, piece, touching=False))
    if len(inside) > PIECE_LIMIT:
        message = f"obstacle `{found.name}` has {len(inside):,} convex pieces within the bounds"
        hint = f"at most {PIECE_LIMIT:,} can be used: take a coarser map, or narrower bounds"
        raise MapFault(message, hint, None if found.image else (0, 1), Code.TOO_LARGE)
    return inside


@lru_cache(maxsize=8)
def objects_within(
    found: ir.ObstacleMap, bounds: ir.Region, *, touching: bool
) -> tuple[Polytope, ...]:
    """The whole pieces of a mesh that meet the bounds; with ``touching`` also those that touch.

    Raises:
        MapFault: the mesh cannot be used.
    """
    every = pieces_of(found).polytopes
    if not every:
        return ()
    area = polytope_of(bounds.shape, every[0].dimension)
    return tuple(piece for piece in every if _meets(area, piece, touching=touching))


def _meets(area: Polytope, piece: Polytope, *, touching: bool) -> bool:
    """Whether a piece meets the bounds or, if ``touching`` does not count, their interior."""
    heights = [
        [value(row, corner.ray) for corner in piece.description.vertices]
        for row in area.integer_rows
    ]
    if all(max(each) <= 0 for each in heights):
        return True
    if any(min(each) > 0 or (min(each) == 0 and not touching) for each in heights):
        return False
    common = area.intersection(piece)
    return not common.is_empty if touching else common.has_interior


@lru_cache(maxsize=8)
def polytopes_within(found: ir.ObstacleMap, bounds: ir.Region) -> tuple[Polytope, ...]:
    """The pieces of a map that meet the interior of the bounds, by their facets.

    Raises:
        MapFault: as for :func:`pieces_within`.
    """
    if found.scene is not None:
        return objects_within(found, bounds, touching=False)
    area = polytope_of(bounds.shape, 2)
    return tuple(
        polytope_of(ir.Hull(piece), 2)
        for piece in pieces_within(found, bounds)
        if not _outside(area, piece, touching=True)
    )


def _outside(area: Polytope, piece: Polygon, *, touching: bool) -> bool:
    """Whether a piece is outside the bounds; if ``touching``, pieces that touch them count.

    The bounds may be unbounded or flat.
    """
    beyond = [
        [row.normal[0] * x + row.normal[1] * y - row.offset for row in area.rows] for x, y in piece
    ]
    if any(max(heights) < 0 for heights in beyond):
        return False
    nearest = [min(heights) for heights in zip(*beyond, strict=True)]
    if any(height > 0 or (touching and height == 0) for height in nearest):
        return True
    corners = area.vertices if area.is_bounded and area.has_interior else ()
    separated = apart if touching else disjoint
    return bool(corners) and separated(tuple((x, y) for x, y in corners), piece)


# --- regions -----------------------------------------------------------------------------------


def expanded_workspace(workspace: ir.Workspace) -> ir.Workspace:
    """A workspace with the pieces of its maps as obstacles after its regions, and without maps.

    Raises:
        MapFault: a map cannot be used.
    """
    return _expanded(workspace)[0]


def _expanded(workspace: ir.Workspace) -> tuple[ir.Workspace, Mapping[str, tuple[str, ...]]]:
    """The workspace without maps, and the names of the pieces of each map."""
    if not workspace.maps:
        return workspace, {}
    names: dict[str, tuple[str, ...]] = {}
    regions = list(workspace.regions)
    for found in workspace.maps:
        pieces = [
            ir.Region(f"{found.name}.{number}", "obstacle", shape, found.span)
            for number, shape in enumerate(_shapes(found, workspace.bounds), start=1)
        ]
        names[found.name] = tuple(piece.name for piece in pieces)
        regions += pieces
    return replace(workspace, regions=tuple(regions), maps=()), names


def _shapes(found: ir.ObstacleMap, bounds: ir.Region) -> Iterator[ir.RegionShape]:
    if found.scene is not None:
        for piece in objects_within(found, bounds, touching=True):
            yield ir.Inequalities(piece.rows)
        return
    for corners in pieces_within(found, bounds):
        yield ir.Hull(corners)


def expanded(program: ir.Program, task: ir.Task) -> tuple[ir.Program, ir.Task]:
    """A program and one of its tasks, with the maps of the task's workspace as obstacles.

    Other workspaces and tasks stay unchanged. Without maps both are returned unchanged.

    Raises:
        MapFault: a map cannot be used.
    """
    workspace = program.workspaces[task.workspace]
    if not workspace.maps:
        return program, task
    place, names = _expanded(workspace)
    named = atoms(*(clause.formula for clause in task.satisfy))
    if any(not names.get(atom.region, "no map") for atom in named):
        place, names = _with_nowhere(place, names)
    made = replace(
        task,
        avoid=tuple(avoid for avoid in (_avoid(a, names) for a in task.avoid) if avoid.regions),
        satisfy=tuple(
            replace(clause, formula=with_atoms(clause.formula, partial(_atom, names=names)))
            for clause in task.satisfy
        ),
    )
    workspaces = {**program.workspaces, place.name: place}
    tasks = {**program.tasks, task.name: made}
    return replace(program, workspaces=workspaces, tasks=tasks), made


def task_by_task(program: ir.Program) -> Iterator[ir.Program]:
    """Programs with one task each and without its maps, for all tasks whose maps can be used.

    A program without maps is returned unchanged, once.
    """
    if not any(workspace.maps for workspace in program.workspaces.values()):
        yield program
        return
    for task in program.tasks.values():
        try:
            single, made = expanded(program, task)
        except MapFault:
            continue  # reported with the workspace
        yield replace(single, tasks={made.name: made})


def _avoid(avoid: ir.Avoid, names: Mapping[str, tuple[str, ...]]) -> ir.Avoid:
    regions = (piece for name in avoid.regions for piece in names.get(name, (name,)))
    return replace(avoid, regions=tuple(regions))


def _atom(atom: ir.Atom, names: Mapping[str, tuple[str, ...]]) -> ir.Formula:
    if atom.region not in names:
        return atom
    atoms = tuple(replace(atom, region=piece) for piece in names[atom.region])
    return atoms[0] if len(atoms) == 1 else ir.Or(atoms, atom.span)


def _with_nowhere(
    workspace: ir.Workspace, names: Mapping[str, tuple[str, ...]]
) -> tuple[ir.Workspace, Mapping[str, tuple[str, ...]]]:
    """Add a box outside the bounds for every map without pieces, so that formulas can name it.

    Formulas have no constants; the bounds keep every effector out of the box.
    """
    size = workspace.dimension
    bounds = polytope_of(workspace.bounds.shape, size)
    right = max(x for x, *_ in bounds.vertices) + 1
    corners = tuple(
        (right + x, *map(Fraction, others)) for x, *others in product((0, 1), repeat=size)
    )
    found = dict(names)
    regions = list(workspace.regions)
    for name, pieces in names.items():
        if not pieces:
            found[name] = (f"{name}.1",)
            regions.append(ir.Region(f"{name}.1", "obstacle", ir.Hull(corners)))
    return replace(workspace, regions=tuple(regions)), found
