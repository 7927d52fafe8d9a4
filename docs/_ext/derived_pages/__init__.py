"""The pages of the site that are written from the program: functionals, the paper, the reference, the gallery."""
