"""Import robots, module sets, tasks and scenes of other tools as `.srg` text."""
