"""The commands: arguments in, texts and exit statuses out."""
