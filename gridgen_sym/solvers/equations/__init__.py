"""The discrete Euler–Lagrange equations, by Newton's method or by relaxation."""
