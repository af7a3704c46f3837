"""Places in the array of numbers that the insertion keeps between calls."""

USED = 0  # cells ever made
FREE = 1  # of them, those that can be used again
LAST = 2  # the cell made last, where the next search starts
STAMP = 3  # number of the present insertion; marks of earlier ones mean nothing
DONE = 4  # points inserted
