"""The linear systems of Newton's method: multigrid where C can be compiled, else a sparse factorization."""
