"""What the page for the browser is told about the spec in its editor."""
