"""From the text of a ``.srg`` file to its typed intermediate representation."""
