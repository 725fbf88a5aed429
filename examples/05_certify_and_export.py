"""
Certify a motion and export it
==============================

A certificate states what a file's motion lets one range tell, computed from the bytes of the file. Anybody can verify
it with the file alone.
"""

# %%
# All files go into a temporary folder; take a folder of your own to keep them.
import tempfile
from pathlib import Path

from rangenav import certificate, preset
from rangenav.certificate import certified_export, exports

folder = Path(tempfile.mkdtemp(prefix="rangenav-"))

# %%
# The preset is saved, and the certificate is computed from what was written.
chosen = preset.load("barrel")
preset.save(chosen, folder / "mine.toml")
found = certificate.certify_file(folder / "mine.toml")
print("certified:", found.certified)
for check in found.checks:
    print(f"  {check.name}: {check.words}")

# %%
# Export for a Crazyflie: pieces of degree 7. The gate refuses what misses its requirement, and the certificate beside
# the file is of the bytes that were written, not of the preset.
exported = certified_export.write(
    chosen, "polynomial", folder / "mine.csv", name="mine", otherwise="uncertified=True writes it all the same"
)
print("in the folder:", *sorted(path.name for path in folder.iterdir()))
for note in exported.notes:
    print("  ", note)

# %%
# Verify: everything is computed again from the file and compared. One changed digit is found.
readers = exports.readers()
print("wrong with the file:", certificate.verify_file(folder / "mine.csv", readers=readers) or "nothing")
lines = (folder / "mine.csv").read_text().splitlines()
lines[1] = lines[1].replace("1", "2", 1)
(folder / "mine.csv").write_text("\n".join(lines) + "\n")
print("after a change:", certificate.verify_file(folder / "mine.csv", readers=readers)[0])
