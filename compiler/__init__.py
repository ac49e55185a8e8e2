"""From the intermediate representation to mathematical objects: automata, robots, cells."""
