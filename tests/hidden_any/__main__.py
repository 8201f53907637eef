"""python -m hidden_any make | diagnose | score; --help."""

from .cli import main

main()
