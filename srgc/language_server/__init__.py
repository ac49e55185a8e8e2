"""The language server: what editors ask about ``.srg`` files, answered over LSP."""
