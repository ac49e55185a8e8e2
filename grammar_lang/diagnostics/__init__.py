"""What is found wrong: codes, their pages, diagnostics and how they are shown."""
