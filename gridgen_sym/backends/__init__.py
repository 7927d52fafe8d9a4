"""The back ends of this package, one folder each. Nothing imports them: they are found by name, like anybody else's."""
