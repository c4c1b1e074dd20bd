"""Published cutting coefficients, each row with its source and what it does not stand for."""

from dataclasses import dataclass

_CJME = "Chinese Journal of Mechanical Engineering 2021, 10.1186/s10033-021-00536-9, Table 5"


@dataclass(frozen=True)
class MaterialRow:
    """Coefficients of the linear force law for one pair of tool and material."""

    cutting: tuple[float, float, float]  # K_tc, K_rc, K_ac, N/m^2; 0 where the source gives none
    edge: tuple[float, float, float]  # K_te, K_re, K_ae, N/m
    source: str

    def coefficients(self) -> dict[str, float]:
        """Return the coefficients under their names in a case file, SI."""
        names = ("Ktc", "Krc", "Kac", "Kte", "Kre", "Kae")
        return dict(zip(names, (*self.cutting, *self.edge), strict=True))


#: name in a case file -> row; coefficients hold for the tool and conditions of their source
MATERIALS: dict[str, MaterialRow] = {
    "Al6061-T6": MaterialRow((243.77e6, 113.5e6, 0.0), (7.53e3, 7.83e3, 0.0), _CJME),
    "Al6082-T6": MaterialRow((631e6, 99e6, 273e6), (13e3, 10e3, 2.8e3), _CJME),
    "Al7075-T6": MaterialRow((767.01e6, 168.8e6, 222e6), (27.7e3, 26.6e3, 0.7e3), _CJME),
    "Al7075-T6 (second source)": MaterialRow(
        (600.46e6, 180.96e6, 0.0), (17.9e3, 20.42e3, 0.0), _CJME
    ),
    "Al7075 HSS": MaterialRow(
        (951.365e6, 262.597e6, 323.33e6), (11.115e3, 11.314e3, 1.105e3), _CJME
    ),
    "Al7075 (Altintas)": MaterialRow(
        (1319.41e6, 788.83e6, 48.75e6), (19.65e3, 26.77e3, 2.05e3), _CJME
    ),
    "steel (80 mm face mill)": MaterialRow(
        (1889.2e6, 806.1e6, 291.0e6),
        (63.12e3, 113.7e3, -3.1e3),
        "Franco et al., shared code of Ideko: 80 mm, two inserts, lead angle 45 degrees",
    ),
    "aluminium (Altintas, Engin, Budak 1999)": MaterialRow(
        (697e6, 255.8e6, 0.0), (0.0, 0.0, 0.0), "Altintas, Engin, Budak 1999"
    ),
    "steel (Cornelius)": MaterialRow(
        # 2160 MPa and 50 N/mm at 68 degrees
        (2002.7171e6, 809.1502e6, 0.0),
        (46.3592e3, 18.7303e3, 0.0),
        "Cornelius et al.: specific force 2160 MPa, force angle 68 degrees, edge force 50 N/mm",
    ),
}
