"""Result folders: a search writes them, and all later commands read them."""
