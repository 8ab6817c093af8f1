"""Interactive plots of a run and of a study: the same as the pictures of `tether.plot`, one file for each kind."""
