# SPDX-License-Identifier: GPL-3.0-or-later
"""Before a benchmark: takes memory in large pages (so many MB, 4000 unless told, or a half of what is free) and gives it
back. What a virtual machine has lent to its host comes back before a run, not in it (docs/reports/performance.md, "Runs
that differ"). The host may take it again after two seconds. 4 GB take six seconds."""

import contextlib
import mmap
import pathlib
import re
import sys

LARGE_PAGE = 1 << 21
LEAST = 32 * LARGE_PAGE  # what an allocator keeps to itself, and caches hold


def warm_memory(size):
    """`size`: bytes. As memory.hpp."""
    if size < LEAST:
        return
    text = pathlib.Path("/proc/meminfo").read_text(encoding="ascii")
    free = int(re.search(r"MemAvailable:\s*(\d+)", text).group(1)) << 10
    size = min(size, free // 2) // LARGE_PAGE * LARGE_PAGE
    with mmap.mmap(-1, size, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS) as memory:
        with contextlib.suppress(OSError):  # a system without large pages
            memory.madvise(mmap.MADV_HUGEPAGE)
        memory[:: mmap.PAGESIZE] = bytes(len(memory) // mmap.PAGESIZE)


if __name__ == "__main__":
    warm_memory(int(sys.argv[1] if len(sys.argv) > 1 else 4000) * 1000**2)
