"""The light of the 3-D picture: one lamp and light from all around, the same for every visitor.

viser's own lights cast shadows and mirror a photograph of a warehouse. A browser that renders in software computes for
about six seconds on that photograph before it shows anything, and a diagram needs neither.
"""

from viser import SceneApi

AMBIENT = 1.8
"""The light from all around: without a photograph, the side of a body that the lamp does not reach would be black."""
LAMP = 1.5
LAMP_TURNED = (0.9, 0.2, 0.3, 0.0)
"""wxyz: the lamp shines obliquely, so that the faces of a body differ."""


def light(scene: SceneApi) -> None:
    """Replace viser's lights for everybody who connects."""
    scene.configure_environment_map(None)
    scene.configure_default_lights(enabled=False)
    scene.add_light_ambient("/lights/ambient", intensity=AMBIENT)
    scene.add_light_directional("/lights/lamp", intensity=LAMP, wxyz=LAMP_TURNED, cast_shadow=False)
