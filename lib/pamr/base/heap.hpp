// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace pamr {

/// Sets the allocator of glibc up for programs that make one mesh after the other: to be called first in `main`, of
/// programs only, since it is the whole process's. Large arrays go back to the system when they are freed: otherwise
/// glibc learns from the first ones to keep them, and the stages of a program add up their peaks. Small memory stays
/// with the process and comes in one large step of 64 MB, in large pages: in small ones, given back and taken anew at
/// every step as glibc does, it costs more page faults than the work on it on a rank with few cells. Does nothing with
/// other C libraries.
void set_up_heap();

}  // namespace pamr
