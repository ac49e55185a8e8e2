"""Tasks run from the editor: lenses, commands, verdicts."""
