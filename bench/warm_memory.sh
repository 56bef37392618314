# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=bash
# Sourced by benchmarks. Takes memory in large pages (4 GB, or a half of what is free) and gives it back: what a virtual
# machine has lent to its host comes back before a run, not in it (docs/reports/performance.md, "Runs that differ"). The host
# may take it again after two seconds.
warm_memory() {
  python3 - <<'EOF'
import mmap, re
free = int(re.search(r"MemAvailable:\s*(\d+)", open("/proc/meminfo").read()).group(1)) << 10
memory = mmap.mmap(-1, min(4 << 30, free // 2 >> 21 << 21), mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
memory.madvise(mmap.MADV_HUGEPAGE)
for page in range(0, len(memory), 1 << 21):
    memory[page] = 1
EOF
}
