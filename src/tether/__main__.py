"""`python -m tether`: the command line, where a launcher such as mpi4py's wants a module."""

from tether.cli import main

if __name__ == "__main__":
    main()
