"""Show designs in motion on a live page."""
