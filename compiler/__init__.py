"""Turns the intermediate representation into mathematical objects: automata, robots, cells."""
