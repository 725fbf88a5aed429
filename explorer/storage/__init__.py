"""What outlives a reload: the work of each tab, presets, certificates, imported and exported files. No viser here."""
