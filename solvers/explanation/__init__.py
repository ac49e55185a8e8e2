"""Why a task was not met: conflicting lines, and what would make it possible."""
