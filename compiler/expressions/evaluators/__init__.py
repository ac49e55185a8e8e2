"""One file per kind of value that an expression graph is evaluated in."""
