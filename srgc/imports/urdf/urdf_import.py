"""``srgc import urdf``: import a robot, or a module with ports, from URDF or xacro."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from srgc.faults import UsageFault
from srgc.imports.body_meshes import BodyMeshes
from srgc.imports.module_set import ModuleSet
from srgc.imports.names import Names
from srgc.imports.source_files import source_files
from srgc.imports.spec_text import spec_text
from srgc.imports.urdf.joint_file import joint_file
from srgc.imports.urdf.joint_motion import JointMotions, held_values
from srgc.imports.urdf.link_parts import LinkParts
from srgc.imports.urdf.robot_model import UrdfRobot, robot_model
from srgc.imports.urdf.robot_modules import RobotModules
from srgc.imports.urdf.xacro_source import expanded_xacro
from srgc.imports.written_import import Imported, mesh_folder
from srgc.version import VERSION


def urdf_import(
    file: Path,
    *,
    name: str | None = None,
    exact: bool = False,
    module: bool = False,
    ports: Sequence[str] = (),
    effectors: Sequence[str] = (),
    fixed: Sequence[str] = (),
    packages: Sequence[str] = (),
    density: float | None = None,
    arguments: Sequence[str] = (),
    pieces: int | None = None,
    detail: float | None = None,
    stem: str | None = None,
) -> Imported:
    """A spec whose only word is the robot, or a spec of one module.

    Args:
        file: a URDF file, or a xacro file if its name ends in ``.xacro``.
        name: the prefix of all names; if None, the name of the robot.
        exact: keep angles and lengths as they are.
        module: make one module with ports.
        ports: the ports of the module, each ``NAME=LINK:TYPE``, and optionally ``:male`` or
            ``:female``.
        effectors: links with effectors; if empty, the last frame.
        fixed: joints that are held, each ``JOINT`` or ``JOINT=VALUE`` (rad, m).
        packages: where packages are, each ``NAME=DIR``.
        density: the density of links without mass (kg/m^3).
        arguments: arguments of a xacro file, each ``NAME:=VALUE``.
        pieces: the most convex pieces of a mesh.
        detail: the share of the volume of a mesh that its pieces may add.
        stem: the name of the spec without its extension, from which the folder of meshes is named;
            if None, the name of the robot.

    Raises:
        UsageFault: the file cannot be read, or an option does not apply to it.
    """
    if ports and not module:
        raise UsageFault("--port goes with --module alone")
    if effectors and module:
        raise UsageFault("--effector does not go with --module")
    files = source_files(file, packages)
    is_xacro = file.suffix == ".xacro"
    if arguments and not is_xacro:
        raise UsageFault(f"--arg goes with xacro, and the name of {file} does not end in .xacro")
    data = expanded_xacro(files, arguments) if is_xacro else files.main_bytes()
    robot = robot_model(data, file, expanded=is_xacro)
    held = held_values(robot, fixed)
    remarks = list[str]()
    prefix = Names().camel(name or robot.name, "Robot")
    folder = mesh_folder(stem or prefix.lower())
    meshes = BodyMeshes(files, folder, remarks, pieces, detail)
    parts = LinkParts(robot, meshes, density, remarks)
    beside = joint_file(files, robot, remarks)
    motions = JointMotions(robot, held, remarks, beside.drives if beside else {})
    if module:
        from srgc.imports.urdf.single_module import SingleModule

        made = SingleModule(robot, parts, motions, prefix, remarks, ports).module_set()
    else:
        made = RobotModules(robot, parts, motions, prefix, remarks, effectors).module_set()
    made.warnings = robot.warnings
    _add_remarks(made, robot, parts, motions)
    made.comments[:0] = [
        f"{robot.name}, imported by srgc {VERSION} from {file.name}.",
        "A module is what moves as one body; its frames are those of the links there.",
    ]
    if beside:
        made.comments.append(f"Rotors and limits of accelerations are those of {beside.name}.")
    text = spec_text(made, exact=exact)
    return Imported(prefix.lower(), text, meshes.written, tuple(made.remarks), robot.warnings)


def _add_remarks(
    made: ModuleSet, robot: UrdfRobot, parts: LinkParts, motions: JointMotions
) -> None:
    """Add remarks on what the language cannot express."""
    if motions.unlimited:
        listed = ", ".join(motions.unlimited)
        made.remarks.append(f"limits of 0 are taken for none: {listed}")
    shaped = [name for name in parts.massless if robot.links[name].collisions]
    if shaped:
        listed = ", ".join(f"`{name}`" for name in shaped)
        made.remarks.append(
            f"links with shapes and without a mass weigh nothing: {listed}; --density gives "
            "them the mass of their shapes"
        )
    soft = [name for name, joint in robot.joints.items() if joint.safety_controller is not None]
    if soft:
        many = "1 joint" if len(soft) == 1 else f"{len(soft)} joints"
        made.remarks.append(f"safety controllers of {many}; ranges are those of <limit>")
    told = [name for name, joint in robot.joints.items() if joint.calibration is not None]
    if told:
        many = "1 joint" if len(told) == 1 else f"{len(told)} joints"
        made.remarks.append(f"calibrations of {many}, which say nothing of how they move")
    if parts.plain_looks:
        listed = ", ".join(f"`{name}`" for name in dict.fromkeys(parts.plain_looks))
        made.remarks.append(f"pictures that are no meshes: {listed}")
    for tag, count in robot.others.items():
        made.remarks.append(f"{count} <{tag}>, which does not describe the body of a robot")
