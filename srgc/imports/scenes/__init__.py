"""Import scenes of other tools as workspaces."""
