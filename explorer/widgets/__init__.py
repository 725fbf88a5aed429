"""Controls that viser lacks, made once and used by every panel."""
