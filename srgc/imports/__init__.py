"""What other tools write, as specifications: robots, meshes and scenes."""
