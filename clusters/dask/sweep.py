"""Runs the shards of a sweep on the workers of a Dask scheduler, each with retries, and says how far it is.

    python sweep.py --scheduler tcp://HOST:8786 --shards 100 -- cohaul sweep SCENARIO --seeds 1000 --threads 1 --out DIR
    cohaul merge DIR --out TABLE

All workers must see the scenario and DIR under the same path. A shard that is finished is skipped, so that the same command goes on from
wherever it was stopped, and a shard that two workers get is written once.
"""

import argparse
import subprocess
import sys
import time

from dask.distributed import Client, as_completed

# A worker that was killed may leave its program at work: the next one waits until that has finished the shard.
BUSY = "another process is at work on it"


def run_shard(command, part):
    while True:
        done = subprocess.run([*command, "--shard", part], capture_output=True, text=True)
        if done.returncode == 0:
            return done.stdout.strip()
        if BUSY not in done.stderr:
            raise RuntimeError(f"shard {part} ended with code {done.returncode}: {done.stderr.strip()}")
        time.sleep(0.5)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--scheduler", metavar="ADDRESS", help="address of the scheduler")
    where.add_argument("--scheduler-file", metavar="FILE", help="file that the scheduler wrote its address to")
    parser.add_argument("--shards", type=int, required=True, metavar="N", help="number of shards")
    parser.add_argument("--retries", type=int, default=3, metavar="N", help="how often a shard that failed is tried again")
    parser.add_argument("command", nargs="+", help="the sweep, without --shard")
    return parser.parse_args()


def main():
    args = arguments()
    parts = [f"{index}/{args.shards}" for index in range(1, args.shards + 1)]
    begun, n_done, failed = time.monotonic(), 0, []
    with Client(args.scheduler, scheduler_file=args.scheduler_file) as client:
        futures = [client.submit(run_shard, args.command, part, retries=args.retries, pure=False) for part in parts]
        for future in as_completed(futures):
            if future.status == "error":
                failed.append(str(future.exception()))
                print(failed[-1], file=sys.stderr)
                continue
            n_done += 1
            passed = time.monotonic() - begun
            left = passed / n_done * (args.shards - n_done - len(failed))
            print(f"{future.result()}; {n_done} of {args.shards}, {n_done / passed:.2f} shards/s, {left:.0f} s left", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
