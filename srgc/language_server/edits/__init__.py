"""Changes of documents: canonical form, quick fixes, renaming."""
