"""How near the algorithms come to the best known fitness: mean gap of 20 runs, 45,000 evaluations.

python experiments/house_algorithm.py
"""

from jaxsusp.optim import devices

RUNS = 20
SETTINGS = {"pso": (500, 90), "sdbo": (500, 30), "jde": (500, 90), "cmaes": (500, 90),
            "routed": (500, 90)}  # fmt: skip


def main() -> None:
    """Print one row per algorithm as Markdown."""
    devices.configure()
    import jaxsusp as js
    from jaxsusp.report.comparison.gaps import clear_runs, mean_gap
    from jaxsusp.report.render import above

    names = js.scenarios()
    print(f"| mean gap in % | {' | '.join(names)} | clear | evaluations | seconds |")
    print("| :--- |" + " ---: |" * (len(names) + 3))
    for algorithm, (iterations, population) in SETTINGS.items():
        ds = js.compare(names, [algorithm], RUNS, iterations, population)
        clear = clear_runs(ds)
        cells = [above(gap) for gap in mean_gap(ds).values[:, 0]]
        cells += [f"{int(clear.sum())}/{clear.size}", f"{int(ds['evaluations'].max()):,}"]
        cells.append(f"{float(ds['seconds_run'].sum()):.1f}")
        print(f"| {algorithm} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
