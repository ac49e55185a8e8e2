"""How robustness depends on parameters: request, computation, text and picture."""
