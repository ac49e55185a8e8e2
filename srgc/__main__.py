"""Run ``srgc`` as ``python -m srgc``."""

from srgc.cli import main

if __name__ == "__main__":
    main()
