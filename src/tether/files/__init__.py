"""Files of a run: trajectory (GSD), series (netCDF), checkpoint (HDF5), summary (JSON).

Every file but the trajectory, which grows, is written under a temporary name and renamed, so that there is
always a whole one.
"""
