"""Converts recorded series of other programs to HDF5 that dyncal reads."""
