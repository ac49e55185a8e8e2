"""Show that a structure cannot do a task: poses, scripts for z3, coverings by boxes."""
