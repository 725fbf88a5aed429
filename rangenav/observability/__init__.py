"""What a motion lets one range tell: excitation, Gramian, rank, blind directions, accuracy (paper, eq. 11–12)."""
