"""The global method: Newton's method on all free nodes at once."""
