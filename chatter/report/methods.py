"""What each command is asked and how it answers, with the source of the method."""

from typing import Any, NamedTuple

from chatter.stability.registry import METHODS as STABILITY_METHODS


class Method(NamedTuple):
    """Question of a command, and how it is answered."""

    question: str
    how: str


METHODS = {
    "new": Method(
        "A first case from five answers.",
        "Answers are put into a case file; what was not asked has the defaults of the schema.",
    ),
    "check": Method(
        "Is the cut stable, and how deep may it be?",
        "Largest Floquet multiplier of the linear delay equation over one period: below 1 in "
        "magnitude, every disturbance dies out (Altintas, Manufacturing Automation, 2012).",
    ),
    "lobes": Method(
        "Which spindle speeds and axial depths are stable?",
        "At each speed the first depth at which the largest Floquet multiplier of the linear "
        "delay equation reaches 1 in magnitude (Altintas, Manufacturing Automation, 2012).",
    ),
    "simulate": Method(
        "What happens in this cut: forces, vibration, surface, chatter or not?",
        "Time domain with regenerative chip thickness: the thinnest of all earlier passes counts, "
        "teeth leave the cut; modes advance exactly over each step (Schmitz and Smith, Machining "
        "Dynamics, 2019). The verdict is by the record, and by perturbed runs where need be.",
    ),
    "bifurcation": Method(
        "Where does the motion change as one value is varied?",
        "A cut is simulated at each value; its Poincaré section, sampled once a period, is a point "
        "where the cut is stable (Nayfeh and Mook, Nonlinear Oscillations, 1979). The largest "
        "multiplier of the linear equations is computed at the same values.",
    ),
    "whatif": Method(
        "What changes if these values change?",
        "Each variant is the case with some values patched, computed as the case itself.",
    ),
    "uncertainty": Method(
        "How likely is stability, with values known within their deviations?",
        "Monte Carlo over the deviations that the case states (Liu, Monte Carlo Strategies in "
        "Scientific Computing, 2001).",
    ),
    "optimum": Method(
        "Which cut removes most within the limits?",
        "Search over speed, depth and width of cut within stability, force and power; each "
        "candidate is judged as by check.",
    ),
    "pitch": Method(
        "Which tooth pitch is most stable?",
        "Search over pitch angles, each judged by the stability of the linear delay equation "
        "(Altintas, Engin and Budak, 1999; Budak, 2003).",
    ),
    "modes": Method(
        "Which modes does the measured response have?",
        "Poly-reference least-squares complex frequency with a stabilisation diagram (Peeters et "
        "al., 2004; Cauberghe et al., 2005), refined by maximum likelihood.",
    ),
    "compare": Method(
        "How far is the prediction of the case from the measurement?",
        "The declared case is computed for each run; error is the rms of measured less predicted "
        "over the rms of the signal.",
    ),
    "explain": Method(
        "What does the declared case lack?",
        "The case is refitted within its tolerances; effects are added one by one, weighed by the "
        "evidence of the model (Whittle, 1953) and judged on runs held out.",
    ),
    "learn": Method(
        "What do the cuts tell about the case, and which cut is next?",
        "Bayes' rule by sequential Monte Carlo (Del Moral, Doucet and Jasra, 2006); the next cut "
        "is the one expected to tell most (Lindley, 1956).",
    ),
    "coefficients": Method(
        "Which coefficients has the force law?",
        "Least squares of mean forces over feed (Budak, Altintas and Armarego, 1996); standard "
        "deviations from the scatter.",
    ),
    "friction": Method(
        "Which friction and inertia has the drive?",
        "Friction laws fitted to the recorded moves and compared on moves held out "
        "(Armstrong-Hélouvry, Dupont and Canudas de Wit, 1994).",
    ),
    "detect": Method(
        "Does the recorded cut chatter, when and at what frequency?",
        "Short-time spectra: chatter is a line off the harmonics of the spindle, with sidebands "
        "one tooth passing frequency apart and a large share of the power (Altintas, Manufacturing "
        "Automation, 2012, section 4.4).",
    ),
    "frf": Method(
        "What does the tool point of the machine feel?",
        "Harmonic solution of the structure with drives and control, or virtual test in time with "
        "H1 (Bendat and Piersol, Random Data, 2010).",
    ),
    "move": Method(
        "How well does the machine follow its path?",
        "The machine with structure, friction, backlash, drives and sampled control is run in "
        "time; contour error is the distance to the path.",
    ),
    "mode-shapes": Method(
        "At which frequencies does the machine vibrate, and how does it move?",
        "Eigenvalues and eigenvectors of the mass and stiffness matrices, without damping, "
        "friction and control (Ewins, Modal Testing, 2000).",
    ),
    "export": Method(
        "The machine as a state space.",
        "Modes of the structure with drives, first order, inputs and outputs at named points.",
    ),
    "assemble": Method(
        "Which receptance has the tool point of this tool, holder and spindle, and which stick-out "
        "is best?",
        "Receptance coupling of modelled or measured parts (Schmitz and Donaldson, Predicting "
        "high-speed machining dynamics by substructure analysis, 2000).",
    ),
    "sheet": Method(
        "Which cuts should the operator use?",
        "Pockets of the stability diagram with margins in depth and speed, as by lobes.",
    ),
    "materials": Method(
        "Which materials have coefficients?", "Table of published coefficients; sources beside."
    ),
    "examples": Method("Which examples are shipped?", "List of the examples in the package."),
    "schema": Method("Which keys may a file have?", "JSON schema, made from the descriptions."),
    "app": Method(
        "Which cuts are stable, seen in the browser?",
        "Stability diagrams of the cases of a folder, drawn again at each change of a value.",
    ),
    "doctor": Method(
        "Is the installation right?", "Versions, cache, and answers known in closed form."
    ),
    "compile": Method(
        "Is everything compiled?", "Every kind of computation once, as small as it can be."
    ),
}


def methods_of(summary: dict[str, Any]) -> list[str]:
    """Sentences on the stability method that a summary names, and on the error it states."""
    name = summary.get("method")
    if not isinstance(name, str):
        return []
    sentences = [f"Method: {name}."]
    if name in STABILITY_METHODS:
        sentences = [f"Method: {name}. {STABILITY_METHODS[name].help}"]
    for where in ("limit", "resolution"):
        error = summary.get(where, {}).get("estimated_error")
        if error is not None:
            # what rounding leaves is below
            sentences.append(
                f"Estimated relative error of the critical depth: {max(error, 1e-6):.1g}."
            )
    return sentences
