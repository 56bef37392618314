// SPDX-License-Identifier: GPL-3.0-or-later
// A call that must not compile; the compiler's message has to name what adds doubles.
#include "pamr/par/comm.hpp"

double mass(const pamr::par::Comm& comm) { return static_cast<double>(comm.sum(0.75)); }
