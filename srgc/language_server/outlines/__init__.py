"""The structure of a document: outline, folds, semantic tokens, links."""
