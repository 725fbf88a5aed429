"""Controls that viser lacks, for all panels."""
