"""Scenes of other tools as workspaces."""
