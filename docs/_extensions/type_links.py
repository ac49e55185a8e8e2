"""Links from annotations to classes: these are written without their modules.

Types are imported for type checkers only, so that Sphinx sees `Program` and not where it is from. A
name that one documented class has is that class.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sphinx.util.nodes import make_refnode

if TYPE_CHECKING:
    from docutils import nodes
    from sphinx.addnodes import pending_xref
    from sphinx.application import Sphinx
    from sphinx.environment import BuildEnvironment


def nearest(
    app: Sphinx, env: BuildEnvironment, node: pending_xref, shown: nodes.TextElement
) -> nodes.Element | None:
    """The class of that name, where there is one only."""
    if node.get("refdomain") != "py":
        return None
    target = node["reftarget"]
    found = [
        (name, entry)
        for name, entry in env.domains["py"].data["objects"].items()
        if name.endswith(f".{target}")
    ]
    if len(found) != 1:
        return None
    [(name, entry)] = found
    return make_refnode(app.builder, node["refdoc"], entry.docname, entry.node_id, shown, name)


def setup(app: Sphinx) -> dict[str, Any]:
    """Connect to references that nothing else resolves."""
    app.connect("missing-reference", nearest)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
