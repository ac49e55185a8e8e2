"""Changes to documents: canonical form, quick fixes, renaming."""
