"""The optimisers on COCO's suite bbob: 24 functions, three dimensions, 15 instances.

    python experiments/bbob.py                                   # all of it: make bbob
    python experiments/bbob.py --algorithms pso --dimensions 5 --budget 1000
    python experiments/bbob.py --resume                          # go on where it was interrupted
    python experiments/bbob.py --draw                            # tables and pictures alone
    python experiments/bbob.py --draw --keep                     # and keep the summary in data/

Evaluations are in float64 and all count; a run ends where it is within 1e-8 of the optimum, or with
its budget. COCO's data files, for `python -m cocopp`, are in OUTPUT/coco; tables and pictures are
drawn from the runs in OUTPUT, or where there are none from the summary that is kept in data/.
"""

import argparse
import time
from pathlib import Path

from jaxsusp.errors import InputError
from jaxsusp.optim import choices, devices

DATA = Path(__file__).with_name("data")
DIMENSIONS, INSTANCES, FUNCTIONS = (5, 10, 20), range(1, 16), range(1, 25)
BUDGET = 10_000  # times D
SUMMARY = ("bbob.csv", "bbob-curves.csv")


def main() -> None:
    """Run what is asked for, then draw all that is there."""
    asked = arguments()
    devices.configure()
    try:
        if not asked.draw:
            run(asked)
        draw(asked)
    except InputError as error:
        raise SystemExit(f"error: {error}") from None


def arguments() -> argparse.Namespace:
    """What a person asks for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add = parser.add_argument
    names = ", ".join(choices.ALGORITHMS)
    said = f"names with commas between them, of {names} and others (all of these)"
    add("--algorithms", type=lambda text: text.split(","), default=[*choices.ALGORITHMS], help=said)
    add("--dimensions", type=numbers, default=[*DIMENSIONS], help="such as 5,10")
    add("--functions", type=numbers, default=[*FUNCTIONS], help="such as 1-14,20")
    add("--instances", type=numbers, default=[*INSTANCES], help="such as 1-15")
    add("--budget", type=int, default=BUDGET, help="evaluations of a run, times D (%(default)s)")
    add("--seed", type=int, default=0, help="root of all randomness (%(default)s)")
    add("--output", type=Path, default=Path("results/bbob"), help="folder (%(default)s)")
    add("--resume", action="store_true", help="leave what is done")
    add("--draw", action="store_true", help="run nothing")
    add("--keep", action="store_true", help="keep the summary in experiments/data")
    return parser.parse_args()


def numbers(text: str) -> list[int]:
    """The numbers in "1-3,7"."""
    ends = [[int(end) for end in part.split("-")] for part in text.split(",")]
    return [number for first, *last in ends for number in range(first, (last or [first])[0] + 1)]


def run(asked: argparse.Namespace) -> None:
    """Every algorithm in every dimension; the quickest dimensions first."""
    from jaxsusp.optim.registry import algorithms
    from jaxsusp.studies.bbob import cocofiles, results
    from jaxsusp.studies.bbob.runs import Course, run_function

    optimizers = algorithms(asked.algorithms)
    plan = [(dim, each) for dim in asked.dimensions for each in optimizers]
    for dim, optimizer in plan:
        course = Course(dim, tuple(asked.instances), asked.budget * dim, seed=asked.seed)
        begun, spent, left = time.perf_counter(), 0.0, len(asked.functions)
        for function in asked.functions:
            left -= 1
            path = results.file_of(asked.output, optimizer.name, dim, function)
            if asked.resume and path.exists():
                results.require_same(path, course)
                continue
            found = run_function(optimizer, function, course)
            folder = asked.output / "coco" / optimizer.name
            cocofiles.write_data(folder, function, dim, found.records)
            kept = results.result(
                optimizer.name, function, course, found.records, found.seconds_run
            )
            results.save(kept, asked.output)
            spent += found.seconds_run
            estimate = spent / (len(asked.functions) - left) * left
            solved = (kept.distance <= results.TARGETS[results.LAST]).sum()
            print(
                f"{optimizer.name} D = {dim} f{function}: {solved}/{len(found.records)} solved, "
                f"{found.seconds_run:.1f} s (compiled in {found.seconds_compile:.1f} s), "
                f"about {estimate:.0f} s left of this dimension",
                flush=True,
            )
        print(f"{optimizer.name} D = {dim}: {time.perf_counter() - begun:.0f} s", flush=True)
    for name in [each.name for each in optimizers]:
        there = [each for each in results.load_all(asked.output) if each.algorithm == name]
        cocofiles.write_info(asked.output / "coco" / name, [each.paragraph for each in there])


def draw(asked: argparse.Namespace) -> None:
    """Tables and pictures of what was run."""
    import pandas as pd

    from jaxsusp._files import write_text
    from jaxsusp.report.drawing.style import save
    from jaxsusp.report.render import to_csv, to_markdown
    from jaxsusp.studies.bbob import pictures, results, summary
    from jaxsusp.studies.bbob.published import beside, published, solved

    found = results.load_all(asked.output)
    results.require_one_course(found)
    budget = found[0].course.budget // found[0].course.dim if found else BUDGET
    if found:
        tables = [summary.running_times(found), summary.distributions(found)]
    else:
        tables = [pd.read_csv(DATA / name) for name in SUMMARY]
    for name, table in zip(SUMMARY, tables, strict=True):
        if asked.keep:
            to_csv(table, DATA / name)
    times, shares = tables
    known = published()
    if not known:
        print("cocopp is not installed: there are no published running times beside ours")
    asked.output.mkdir(parents=True, exist_ok=True)
    parts = [solved(times, known, budget)]
    parts += [beside(times, known, dim) for dim in sorted({*times["dimension"]})]
    write_text(asked.output / "tables.md", "\n\n".join(map(to_markdown, parts)) + "\n")
    what = f"bbob, {budget:,} D evaluations a run, {int(times['runs'].max())} instances"
    for dim in sorted({*shares.get("dimension", ())}):
        title = f"Targets from 100 to 1e-8 above f_opt, D = {dim}: {what}"
        save(pictures.curves(shares, dim, title), asked.output / f"bbob-{dim}.png")
    if len(shares):
        note = "Published: running times that COCO ships with cocopp, of 2009 and 2010, cut here."
        figure = pictures.beside_published(shares, known, f"Functions solved: {what}", note)
        save(figure, asked.output / "bbob-published.png")
    print(f"tables and pictures are in {asked.output}")


if __name__ == "__main__":
    main()
