"""The claims of a verdict, as data, and those checks of them that need no integration."""
