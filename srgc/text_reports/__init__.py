"""The reports that commands print, as text and as JSON."""
