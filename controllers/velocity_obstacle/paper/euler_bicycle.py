"""The kinematic bicycle in explicit Euler steps, and how its states depend on the inputs.

``along+ = along + T v cos(heading)``, ``across+ = across + T v sin(heading)``,
``heading+ = heading + T v tan(steering) / wheelbase``, ``v+ = v + dv``, ``steering+ = steering + ddelta``,
all with the values before the step. So an input first shows in the speed, one step later in the position;
a steering input moves the vehicle sideways only three steps later.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray

# Order of the states, and of the inputs.
ALONG, ACROSS, HEADING, SPEED, STEERING = range(5)
SPEED_CHANGE, STEERING_CHANGE = range(2)


@dataclass(frozen=True, slots=True)
class EulerBicycle:
    """A bicycle with a fixed wheelbase and a fixed step length.

    Parameters
    ----------
    wheelbase
        Distance between the axles [m].
    step
        Step length T [s].

    Notes
    -----
    Eqs. (7) to (11) of [VOMPC2019]_. Its Eq. (5) divides by the tangent, which (4) and (9) contradict. In
    (7) and (8), rates are multiplied by T; here, the inputs are the changes themselves. The paper counts the
    heading from the x-axis; here, it is counted from the lane.
    """

    wheelbase: float
    step: float

    def states(self, start: FloatArray, inputs: FloatArray) -> FloatArray:
        """Return the states at the beginning and after each input, shape (..., 5, n + 1).

        Parameters
        ----------
        start
            Along, across, heading, speed and steering, shape (5,) [m, m, rad, m/s, rad].
        inputs
            Changes of speed and steering, shape (..., 2, n) [m/s, rad].

        >>> bicycle = EulerBicycle(wheelbase=2.6, step=1.0)
        >>> bicycle.states(np.array([0.0, 0.0, 0.0, 7.0, 0.0]), np.array([[1.0, 0.0], [0.0, 0.0]]))[ALONG]
        array([ 0.,  7., 15.])
        """
        speed = start[SPEED] + _sums(inputs[..., SPEED_CHANGE, :])
        steering = start[STEERING] + _sums(inputs[..., STEERING_CHANGE, :])
        turn = self.step / self.wheelbase * (speed * np.tan(steering))[..., :-1]
        heading = start[HEADING] + _sums(turn)
        moved = self.step * speed[..., :-1]
        along = start[ALONG] + _sums(moved * np.cos(heading[..., :-1]))
        across = start[ACROSS] + _sums(moved * np.sin(heading[..., :-1]))
        return np.stack([along, across, heading, speed, steering], axis=-2)

    def sensitivities(self, states: FloatArray) -> FloatArray:
        """Return the derivatives of the states after each input by all inputs, shape (5, n, 2 n).

        Parameters
        ----------
        states
            As from ``states``, of one motion: shape (5, n + 1).
        """
        n = states.shape[1] - 1
        _, _, heading, speed, steering = states[:, :n, None]
        gain = np.zeros((5, n + 1, 2 * n))
        later = np.tri(n + 1, n, -1)
        gain[SPEED, :, :n] = later
        gain[STEERING, :, n:] = later
        tangent = np.tan(steering)
        turn = tangent * gain[SPEED, :n] + speed * (1.0 + tangent**2) * gain[STEERING, :n]
        gain[HEADING, 1:] = self.step / self.wheelbase * np.cumsum(turn, axis=0)
        cos, sin = np.cos(heading), np.sin(heading)
        onward = cos * gain[SPEED, :n] - speed * sin * gain[HEADING, :n]
        sideways = sin * gain[SPEED, :n] + speed * cos * gain[HEADING, :n]
        gain[ALONG, 1:] = self.step * np.cumsum(onward, axis=0)
        gain[ACROSS, 1:] = self.step * np.cumsum(sideways, axis=0)
        return gain[:, 1:]


def _sums(values: FloatArray) -> FloatArray:
    """Return the sums of the first 0, 1, ... values."""
    begun = np.zeros((*values.shape[:-1], 1))
    return np.concatenate((begun, np.cumsum(values, axis=-1)), axis=-1)
