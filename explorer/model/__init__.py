"""What is chosen and what follows from it: values, stages of computing, jobs. No viser here."""
