"""How firm contacts between the simulated objects are."""

from __future__ import annotations

import mujoco


def soften_contacts(model: mujoco.MjModel, width: float) -> None:
    """Have the firmness of every contact grow from nothing, so that its force is continuous.

    MuJoCo's default impedance is 0.9 at first touch: a contact takes nearly its whole load at once. What
    the held object pushes then leaves it and meets it again about a hundred times a second, and the force
    on the cup jumps between 2 and 12 N although the torques of the arm are smooth. From an impedance of 0
    on, the force grows with the penetration instead, as where cartons and shrink film give way. Under
    load the contact is no softer: 15 N press 0.5 kg in by 0.6 mm, and by 0.7 mm with the default.

    Args:
        model: changed in place.
        width: penetration at which a contact has MuJoCo's largest impedance, 0.95 [m]; 0 leaves the default.
    """
    if width > 0.0:
        # solimp: impedance at first touch, largest impedance, width, and the shape of the curve between
        model.geom_solimp[:, 0], model.geom_solimp[:, 2] = 0.0, width
