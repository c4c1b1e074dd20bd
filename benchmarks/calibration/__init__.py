"""Survey of `chatter explain`: do its probabilities mean what they say, and how often is it wrong?

    python -m benchmarks.calibration OUT --count 300 --seed 1 [--kinds frf axis stability]
    python -m benchmarks.calibration OUT --report

Sets are those of `benchmarks.blind_sets`, whose physics shares nothing with the packages under
test. Every set depends on the seed and its own number alone; each answer is a line of
OUT/answers.jsonl as soon as it is known, so that a run that was ended goes on where it stopped.
`--report` writes OUT/reliability.png and prints the table.

| module | what it does |
|---|---|
| `answers` | draws a set, explains it, and keeps what was said beside the truth |
| `reliability` | expected calibration error, bins, wrong names, shares by kind |
| `picture` | reliability diagram |
"""
