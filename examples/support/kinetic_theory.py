# SPDX-License-Identifier: MIT
"""The steady state of a bed of smooth inelastic spheres on a vibrating floor, by kinetic theory.

    bed = SteadyBed(mass_holdup=2.5, boundary_velocity=2)
    bed.y, bed.solid_fraction, bed.temperature     profiles, from the floor up
    bed.mean_temperature                           mass-weighted

Lengths in diameters d, temperatures T = <v'^2>/3 in g d, pressure in rho_p g d. With the solid
fraction nu, the contact value g0 of Carnahan and Starling, and G = nu g0:

    weight             dP/dy = -nu
    equation of state  P = nu T (1 + 2 (1 + e) G)
    loss               dq/dy = -(12/sqrt(pi)) (1 - e^2) nu G T^{3/2}
    conduction         q = -(4/sqrt(pi)) M nu G sqrt(T) dT/dy,  M = 1 + (9 pi/32) (1 + 5/(12 G))^2

with the constitutive laws of nearly elastic spheres (Jenkins and Richman 1985). At the floor
P = m_t. From the collision integrals, the heat flux from a flat wall with Gaussian velocity of mean
square V_b^2 into a Maxwellian gas, with S = T + V_b^2 the mean square of the relative velocity, is

    q = P sqrt(8 S/pi) ((1 + e_b)/2 - T/S).

At the top q -> 0 as P -> 0. P decreases from floor to top and replaces y as independent variable.
The equations are integrated from the top down, because errors of the initial values then decay; the
only unknown is the temperature at the top.
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

ROOT_PI = np.sqrt(np.pi)


def contact_value(solid_fraction):
    """g0 of Carnahan and Starling (1969) [-]."""
    return (2 - solid_fraction) / (2 * (1 - solid_fraction) ** 3)


class SteadyBed:
    """mass_holdup m_t, boundary_velocity V_b (rms, over sqrt(g d)), restitution e of two spheres
    and floor_restitution e_b; raises ValueError if no steady state is found."""

    def __init__(self, mass_holdup, boundary_velocity, restitution=0.9, floor_restitution=None):
        self.mass_holdup = mass_holdup
        self.mean_square = boundary_velocity ** 2
        self.e = restitution
        self.e_b = restitution if floor_restitution is None else floor_restitution
        falling = self._integrate(self._temperature_at_the_top())
        P = np.linspace(falling.t[0], mass_holdup, 4000)[::-1]
        T, _, depth = falling.sol(P)
        self.y = 0.5 + depth[0] - depth  # the lowest centres are half a diameter above the floor
        self.temperature = T
        self.solid_fraction = np.array([self._solid_fraction(p, t) for p, t in zip(P, T)])
        # Mass-weighted: dP = -nu dy.
        self.mean_temperature = float(-np.trapz(T, P) / mass_holdup)
        self.centre_of_mass = float(-np.trapz(self.y, P) / mass_holdup)
        peak = int(np.argmax(self.solid_fraction))
        self.solid_fraction_max = float(self.solid_fraction[peak])
        self.solid_fraction_peak = float(self.y[peak])

    def _solid_fraction(self, P, T):
        def excess(nu):
            return nu * (1 + 2 * (1 + self.e) * nu * contact_value(nu)) - P / T
        return brentq(excess, 0, 0.9999)

    # (T, q, depth below the top) over P.
    def _slopes(self, P, state):
        T, q, _ = state
        nu = self._solid_fraction(P, T)
        G = nu * contact_value(nu)
        M = 1 + 9 * np.pi / 32 * (1 + 5 / (12 * G)) ** 2
        return [q * ROOT_PI / (4 * M * nu * G * np.sqrt(T) * nu),
                12 / ROOT_PI * (1 - self.e ** 2) * G * T ** 1.5,
                1 / nu]

    def _integrate(self, T_top):
        # Near the top nu = P/T, and q is the integral of the loss 12/sqrt(pi) (1 - e^2) P sqrt(T).
        P = 1e-6 * self.mass_holdup
        q = 6 / ROOT_PI * (1 - self.e ** 2) * np.sqrt(T_top) * P ** 2
        result = solve_ivp(self._slopes, (P, self.mass_holdup), [T_top, q, 0], method="LSODA",
                           rtol=1e-8, atol=1e-12, dense_output=True)
        if not result.success:
            raise ValueError(f"kinetic theory: {result.message}")
        return result

    def _too_much_heat(self, log_T_top):
        T, q, _ = self._integrate(np.exp(log_T_top)).y[:, -1]
        S = T + self.mean_square
        return q - self.mass_holdup * np.sqrt(8 * S / np.pi) * ((1 + self.e_b) / 2 - T / S)

    def _temperature_at_the_top(self):
        # The heat flux at the floor increases with the temperature at the top.
        high = np.log(10 * self.mean_square)
        while self._too_much_heat(high) < 0:
            high += 1
        low = high
        while self._too_much_heat(low) > 0:
            low -= 0.5
            if low < high - 40:
                raise ValueError(f"kinetic theory: no steady state for m_t = {self.mass_holdup:g}, "
                                 f"V_b = {np.sqrt(self.mean_square):g}")
        return np.exp(brentq(self._too_much_heat, low, low + 0.5, xtol=1e-12))
