"""``python -m srgc`` is ``srgc``."""

from srgc.cli import main

if __name__ == "__main__":
    main()
