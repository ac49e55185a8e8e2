"""SVG charts and pictures of robots and workspaces, for files, reports and notebooks."""
