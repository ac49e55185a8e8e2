"""From the syntax tree to the intermediate representation, checking sorts, units and values."""
