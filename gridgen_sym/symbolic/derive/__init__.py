"""Derive: the discrete energy's derivatives and the continuous equations, from one density."""
