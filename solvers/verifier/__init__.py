"""The independent verifier: what decides whether a verdict is believed; it loads no searcher."""
