"""Files: the work of each tab, presets, certificates, imports and exports. Nothing here imports viser."""
