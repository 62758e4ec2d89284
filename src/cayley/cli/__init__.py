"""The command line: `cayley run`, `cayley cite`, and scenarios in TOML files."""
