"""The language server: answers the requests of editors about ``.srg`` files over LSP."""
