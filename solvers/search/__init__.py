"""Algorithm 1: structures, paths, parameters and motions, until a verdict can be proved."""
