"""Robots, module sets, tasks and scenes of other tools, written as `.srg` text."""
