"""How robustness depends on parameters: asked, computed, printed, drawn."""
