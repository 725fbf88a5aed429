"""What one range determines of a motion: excitation, Gramian, rank, blind directions, accuracy (paper, eq. 11–12)."""
