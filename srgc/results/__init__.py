"""Result folders: written by a search, read by everything that comes after it."""
