"""The answers about the spec in the editor of the browser page."""
