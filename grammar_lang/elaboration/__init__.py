"""From the syntax tree to the intermediate representation: sorts, units and values checked."""
