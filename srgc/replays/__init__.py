"""The planned inputs in other simulators, compared with the certified tube."""
