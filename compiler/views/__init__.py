"""Pictures of families, robots and workspaces as DOT texts."""
