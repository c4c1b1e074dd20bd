"""Blind generator: measurement sets with effects drawn at random, to test `chatter explain`.

    python -m benchmarks.blind_sets OUT --kind milling --count 20 --seed 1 [--effect NAME]
    python -m benchmarks.blind_sets.score OUT

| module | what it does | physics |
|---|---|---|
| `milling_physics` | a cut in time | Runge-Kutta on the modes, history by Hermite polynomials |
| `milling_effects` | effects of a cut, each with random parameters | |
| `milling` | draws cuts, runs them, writes sets | |
| `recorded` | those cuts as a shop records them: from the air or in the cut, turned, drifting | |
| `axis_physics`, `axis` | feed axis under position control | Runge-Kutta on mass, friction, gap |
| `stability_physics`, `stability` | points judged stable or chatter | growth of a disturbance |
| `frf` | tap tests idle and in the cut | sums of modes |
| `files` | folders, case files, truth files | |
| `score` | what `chatter explain` made of the sets | |

Nothing here but `score` imports the packages under test. Truth lies in OUT/truth, never in a set.
"""
