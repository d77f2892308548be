#!/usr/bin/env python3
"""A fleet's logs as a map and a reduce under Dask.

usage: schunk.py GELENK DESCRIPTION RUNS.csv FOLDER

RUNS.csv holds runs of one robot, numbered by the column `run`; each becomes a log of its own in FOLDER, as if it came from
another robot. Each log is a task that calls `gelenk identify --reduce`, pairs of moments are tasks that add them up, and the last
task identifies. The same is done by a single process, one `--reduce` over all logs and one `--merge`. Exit code 1 where a number of
the two results differs by more than 1e-10, relative to the larger one or absolute below one.
"""
import json
import math
import os
import shutil
import subprocess
import sys

from dask.distributed import Client, LocalCluster

MOST = 1e-10
# The robot compensates its gravity, its runs of 3 s are too short to find delay and bandwidth in each of them.
OPTIONS = ["--gravity-compensated", "--effort", "joint", "--bandwidth", "20", "--delay", "0"]


def split(runs, folder):
    """One CSV for each run, without the column `run`."""
    logs, out, current = [], None, None
    with open(runs, encoding="utf-8") as rows:
        header = next(rows).split(",", 1)[1]
        for row in rows:
            run, rest = row.split(",", 1)
            if run != current:
                if out:
                    out.close()
                current = run
                logs.append(os.path.join(folder, f"run_{int(run):03}.csv"))
                out = open(logs[-1], "w", encoding="utf-8")
                out.write(header)
            out.write(rest)
    out.close()
    return logs


def gelenk(arguments):
    done = subprocess.run(arguments, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(arguments)}: {done.stderr[-2000:]}")
    return json.loads(done.stdout)


def reduce_logs(program, description, logs, output):
    gelenk([program, "identify", description, "--reduce", *logs, "--output", output, "--format", "json", *OPTIONS])
    return output


def add(program, description, files, output):
    gelenk([program, "identify", description, "--merge", *files, "--output", output, "--format", "json"])
    return output


def identified(program, description, file, output):
    return gelenk([program, "identify", description, "--merge", file, "--output", output, "--format", "json"])


def by_dask(client, program, description, logs, folder):
    def place(name):
        return os.path.join(folder, name)

    reduced = [client.submit(reduce_logs, program, description, [log], log.replace(".csv", ".moments")) for log in logs]
    level = 0
    while len(reduced) > 1:
        pairs = [reduced[i : i + 2] for i in range(0, len(reduced), 2)]
        reduced = [
            client.submit(add, program, description, pair, place(f"sum_{level}_{i}.moments")) if len(pair) > 1 else pair[0]
            for i, pair in enumerate(pairs)
        ]
        level += 1
    result = client.submit(identified, program, description, reduced[0], place("by_dask.toml"))
    return reduced[0].result(), result.result()


def numbers(value, path=""):
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from numbers(inner, f"{path}.{key}")
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from numbers(inner, f"{path}[{i}]")
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield path, float(value)


def difference(one, other):
    a, b = dict(numbers(one)), dict(numbers(other))
    if a.keys() != b.keys():
        return len(a), math.inf
    return len(a), max(abs(a[k] - b[k]) / max(1.0, abs(a[k]), abs(b[k])) for k in a)


def content(path):
    with open(path, "rb") as file:
        return file.read()


def main():
    program, description, runs, folder = sys.argv[1:]
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    logs = split(runs, folder)
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        tree, fleet = by_dask(client, program, description, logs, folder)
    single = reduce_logs(program, description, logs, os.path.join(folder, "single.moments"))
    alone = identified(program, description, single, os.path.join(folder, "single.toml"))
    count, largest = difference(fleet, alone)
    same = content(tree) == content(single)
    print(f"{len(logs)} logs of {sum(map(os.path.getsize, logs))} bytes, moments of {os.path.getsize(tree)} bytes")
    for joint in fleet["joints"]:
        print(f"{joint['name']}: R² {joint['r_squared_held_out']:.4f} held out, {joint['friction']}")
    print(f"Dask and a single process: {count} numbers differ by at most {largest:.1e}, moments are {'the same' if same else 'other'} bytes")
    return 0 if largest <= MOST else 1


if __name__ == "__main__":
    sys.exit(main())
