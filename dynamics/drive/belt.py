"""Toothed belt between a motor and what it drives."""

from dataclasses import dataclass

from dynamics.beam.element import positive
from dynamics.drive.gear_train import Spring, Stage
from dynamics.drive.parts import require_not_negative, require_stiffness


@dataclass(frozen=True)
class Belt:
    """Belt and its two pulleys, on parallel axes in one housing.

    Raises
    ------
    StructureError
        If a radius or the stiffness is not above 0, or a value negative.
    """

    driver_radius: float  # pitch radius of the pulley at the motor, m
    driven_radius: float  # of the pulley behind it, m
    #: of both strands together, N/m along the belt: 2 E A/L of tensioned strands of length L
    stiffness: float
    damping: float = 0.0  # N s/m along the belt
    #: kg m^2; 0 where a pulley sits rigidly on a beam or body that has it
    driver_inertia: float = 0.0
    driven_inertia: float = 0.0  # likewise

    def __post_init__(self) -> None:
        positive("belt", "driver_radius", self.driver_radius)
        positive("belt", "driven_radius", self.driven_radius)
        require_stiffness("belt", stiffness=self.stiffness)
        require_not_negative(
            "belt",
            damping=self.damping,
            driver_inertia=self.driver_inertia,
            driven_inertia=self.driven_inertia,
        )

    @property
    def ratio(self) -> float:
        """Angle of the driven over angle of the driving pulley."""
        return self.driver_radius / self.driven_radius

    def spring(self, name: str, travel: float) -> Spring:
        """The belt's strands, seen from an axis of so much travel per angle of the driven pulley.

        The travel is in m/rad.
        """
        stretch = self.driven_radius / travel
        return Spring(name, self.stiffness * stretch**2, self.damping * stretch**2)


def belt_stages(
    prefix: str, motor_inertia: float, belt: Belt, travel: float, behind: Spring
) -> list[Stage]:
    """Motor and driven pulley, with what lies behind the pulley.

    Inertia of the motor, kg m^2, and travel of the axis per angle of the driven pulley, m/rad; the
    prefix is that of names.
    """
    strands = belt.spring(f"{prefix}belt", travel)
    inertia = motor_inertia + belt.driver_inertia
    return [
        Stage(f"{prefix}motor", inertia, travel * belt.ratio, strands),
        Stage(f"{prefix}pulley", belt.driven_inertia, travel, behind),
    ]
