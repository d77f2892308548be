"""Remedies that `gelenk identify` offers for the logs of stick.py, and those that are false.

    python remedies.py --gelenk gelenk --work build --seeds 0-6        # the logs of README.md
    python remedies.py --gelenk gelenk --work build --seeds 7-31       # 300 further ones

A remedy is a finding with the share by which the error on held-out data falls. It is false unless the log has its fault.
Refusals without a remedy are counted apart. The exit code is 1 if more than 1 % of the logs have a false remedy.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys

from stick import KINDS, Simulator, numbers, simulate, write_urdf

FALL = "fall of the held-out error"
REFUSED = "refused"
# The code of the remedy for what a kind has and the description lacks.
FAULTS = dict(delay={"other-delay"}, spring={"spring"}, load={"friction-under-load"})
MOST = 0.01


def remedies(job):
    gelenk, work, kind, seed = job
    name = f"{kind}_{seed}"
    log = work / f"{name}.csv"
    if not log.exists():
        simulate(Simulator(work), work, kind, seed)
    command = [gelenk, "identify", "arm4.urdf", log.name, "-o", f"{name}.toml", "--format", "json"]
    run = subprocess.run(command, cwd=work, capture_output=True, text=True)
    found = json.loads(run.stdout) if run.stdout.strip() else {}
    offered = [x for x in found.get("findings", found.get("diagnostics", [])) if any(v["name"] == FALL for v in x.get("values") or [])]
    if run.returncode and not offered:
        offered = [dict(code=REFUSED, text=run.stderr)]
    return kind, name, offered


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--gelenk", default="gelenk", help="the program")
    parser.add_argument("--work", default="build", type=pathlib.Path, help="folder of logs; those that it has are kept")
    parser.add_argument("--kinds", default=",".join(KINDS), help="kinds, separated by commas")
    parser.add_argument("--seeds", default="7-31", help="seeds, as 0-6 or 0,3")
    parser.add_argument("--jobs", default=1, type=int, help="logs at once")
    choice = parser.parse_args()
    work = choice.work.resolve()
    work.mkdir(parents=True, exist_ok=True)
    write_urdf(work / "arm4.urdf")
    Simulator(work)
    gelenk = str(pathlib.Path(choice.gelenk).resolve()) if os.sep in choice.gelenk else choice.gelenk
    jobs = [(gelenk, work, kind, seed) for seed in numbers(choice.seeds) for kind in choice.kinds.split(",")]
    false, refused, right = [], [], 0
    with concurrent.futures.ProcessPoolExecutor(choice.jobs) as pool:
        for kind, name, offered in pool.map(remedies, jobs):
            right += any(x["code"] in FAULTS.get(kind, ()) for x in offered)
            wrong = [x for x in offered if x["code"] not in FAULTS.get(kind, ())]
            for x in wrong:
                print(f"{name}: {x['text']}", flush=True)
            is_refused = [x["code"] for x in wrong] == [REFUSED]
            (refused if is_refused else false).extend([name] if wrong else [])
    print(f"{len(jobs)} logs: false remedies in {len(false)} {false}, right ones in {right}, refused without one {refused}")
    sys.exit(len(false) > MOST * len(jobs))


if __name__ == "__main__":
    main()
