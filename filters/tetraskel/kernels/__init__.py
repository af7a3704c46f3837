"""The mathematics: arrays in, arrays out; NumPy, and SciPy where it is there. No VTK."""
