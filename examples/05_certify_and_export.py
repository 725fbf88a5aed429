"""
Certify a motion and export it
==============================

A certificate states what one range can determine on the motion in a file. The certificate is computed from the bytes of
the file, so anybody who has both files can verify it.
"""

# %%
# The example writes all files into a temporary folder. Use a folder of your own to keep them.
import tempfile
from pathlib import Path

from rangenav import certificate, preset
from rangenav.certificate import certified_export, exports

folder = Path(tempfile.mkdtemp(prefix="rangenav-"))

# %%
# Save the preset, and compute the certificate from the file.
chosen = preset.load("barrel")
preset.save(chosen, folder / "mine.toml")
certified = certificate.certify_file(folder / "mine.toml")
print("certified:", certified.certified)
for check in certified.checks:
    print(f"  {check.name}: {check.words}")

# %%
# Export the motion for a Crazyflie, as polynomials of degree 7. ``write`` refuses a preset that misses its requirement;
# ``otherwise`` is the advice that its error message then ends with. The certificate is computed from the exported
# bytes, not from the preset.
exported = certified_export.write(
    chosen, "polynomial", folder / "mine.csv", name="mine", otherwise="uncertified=True writes it all the same"
)
print("in the folder:", *sorted(path.name for path in folder.iterdir()))
for note in exported.notes:
    print("  ", note)

# %%
# ``verify_file`` computes the certificate again from the file and compares the two. It detects one changed digit.
readers = exports.readers()
print("wrong with the file:", certificate.verify_file(folder / "mine.csv", readers=readers) or "nothing")
lines = (folder / "mine.csv").read_text().splitlines()
lines[1] = lines[1].replace("1", "2", 1)
(folder / "mine.csv").write_text("\n".join(lines) + "\n")
print("after a change:", certificate.verify_file(folder / "mine.csv", readers=readers)[0])
