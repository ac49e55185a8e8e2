"""Charts, robots and workspaces as SVG: for files, for the report and for notebooks."""
