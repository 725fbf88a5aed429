"""What of the worst rank depends on the anchor, and what does not."""

import numpy as np
from msgspec.structs import replace

from rangenav import preset
from rangenav.observability import spectrum
from rangenav.observability.worst_rank import worst_rank
from rangenav.progress import stopping


def test_an_anchor_that_moves_leaves_the_lifted_rank_and_computes_the_nonlinear_one_anew():
    p, asked = preset.load("paper-slow"), []
    path, window = p.path.slowed(1.001), p.requirement.window

    def wanted() -> bool:
        asked.append(1)
        return False

    with stopping(wanted):
        before = worst_rank(path, p.world, 8.0, window)
        steps = len(asked)
        moved = replace(p.world, anchor=(1.0, -2.0, 0.5))
        after = worst_rank(path, moved, 8.0, window)
    assert steps > 0
    assert len(asked) == steps  # no window and no core was decomposed
    assert after.proof == before.proof
    np.testing.assert_array_equal(after.eigenvalues, before.eigenvalues)
    for of, world in ((before, p.world), (after, moved)):
        alone = spectrum.nonlinear_spectra(path, world.anchor, np.array([of.nonlinear_at]), window)
        np.testing.assert_allclose(of.nonlinear_eigenvalues, alone.eigenvalues[0], rtol=1e-9)
    assert not np.array_equal(after.nonlinear_eigenvalues, before.nonlinear_eigenvalues)
