# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A gap of a minute that is fetched beside live topics: how soon, at what price for them, and what it shows.

Run it with ``python benchmarks/catch_up.py``; it takes a minute. All is in virtual time, over the simulated
link of the tests: both ends are those that run, the link has a rate, a delay and a queue without end. Live
topics take 0.2 of 0.25 MB/s; the gap holds ``/odom`` at 25 Hz and ``/scan`` at 5 Hz.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1] / "tests"))

from link.protocol.simulated_link import Ends, S, quantile
from link.transfer.fetched_path import path_errors
from link.transfer.simulated_fetch import GAP, LIVE, NEEDS, SPARE_LINK, Contents, FetchingEnds, spare_link

GAP_S = 60.0
FROM_S = 10.0
RUN_S = 150.0
DELAYS_MS = (2, 20, 100)
SHARES = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5)


def main() -> int:
    """Print two tables, and return 1 where a target is missed."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--delays-ms", type=float, nargs="+", default=DELAYS_MS, help="of the link, one way")
    delays_s = [delay_ms / 1000 for delay_ms in parser.parse_args().delays_ms]
    contents = Contents.of(GAP, GAP_S)
    missed = print_ages(contents, delays_s) + print_errors(contents)
    return int(missed > 0)


def print_ages(contents: Contents, delays_s: Sequence[float]) -> int:
    """Ages of live messages with and without a fetch; how many targets were missed."""
    size_mb = contents.order.size_bytes / 1e6
    print(f"{size_mb:.2f} MB of a gap of {GAP_S:g} s, a link of {SPARE_LINK / 1e3:g} KB/s\n")
    print("| delay one way | gap there after | sent twice | topic | p95 without, ms | p95 beside it, ms |")
    print("| ---: | ---: | ---: | --- | ---: | ---: |")
    missed = 0
    for delay_s in delays_s:
        alone, beside = (
            Ends(spare_link(delay_s), LIVE),
            FetchingEnds(spare_link(delay_s), LIVE, contents=contents, from_s=FROM_S),
        )
        for one in (alone, beside):
            one.sender.follow(NEEDS)
            one.run(RUN_S)
        done_s = (beside.done_ns or int(RUN_S * S)) / S
        is_same = beside.has_all
        twice = beside.sent_bytes - contents.order.size_bytes
        for topics in ([one.topic for one in LIVE], *([one.topic] for one in LIVE)):
            before, after = (1e3 * quantile(ages_s(one, topics, done_s), 0.95) for one in (alone, beside))
            name = "all" if len(topics) > 1 else f"`{topics[0]}`"
            head = f"{delay_s * 1e3:g} ms | {done_s - FROM_S:.1f} s | {twice}" if name == "all" else " | | "
            print(f"| {head} | {name} | {before:.1f} | {after:.1f} |")
            missed += name == "all" and after > 1.1 * before
        missed += not is_same
    return missed


def ages_s(ends: Ends, topics: Sequence[str], done_s: float) -> list[float]:
    """While the fetch goes on."""
    return [age for topic in topics for age in ends.ages_s(topic, FROM_S, done_s)]


def print_errors(contents: Contents) -> int:
    """What of the path is shown after a share of the bytes; how many targets were missed."""
    print("\n| bytes | coarse first, RMSE in m | in order | newest first |")
    print("| ---: | ---: | ---: | ---: |")
    missed = 0
    for share in (0.0, *SHARES):
        errors = path_errors(contents, share)
        ours = errors.coarse_first_m
        print(f"| {100 * share:g} % | {ours:.3f} | {errors.in_order_m:.3f} | {errors.newest_first_m:.3f} |")
        missed += share == 0.1 and ours > 0.2 * errors.nothing_m
    return missed


if __name__ == "__main__":
    sys.exit(main())
