// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/base/error.hpp"

namespace pamr {

[[noreturn]] void contract_violated(const char* kind, const char* condition, const char* file, int line);

/// Where the program cannot come: throws `ContractViolation` with what should have kept it away.
/// `file` and `line`: of the call (built-ins, since clang 14 has no `std::source_location`).
[[noreturn]] inline void unreachable(const char* because, const char* file = __builtin_FILE(),
                                     int line = __builtin_LINE()) {
  contract_violated("unreachable", because, file, line);
}

/// Narrows an integer after checking that the value fits; throws `ContractViolation` otherwise.
template <class To, class From>
constexpr To narrow(From value) {
  const auto result = static_cast<To>(value);
  if (static_cast<From>(result) != value || ((result < To{}) != (value < From{})))
    contract_violated("narrow", "value fits the target type", __FILE__, __LINE__);
  return result;
}

}  // namespace pamr

/// Cheap checks, always on: the caller's fault (EXPECTS) or ours (ENSURES).
#define PAMR_EXPECTS(condition) \
  ((condition) ? void() : ::pamr::contract_violated("precondition", #condition, __FILE__, __LINE__))
#define PAMR_ENSURES(condition) \
  ((condition) ? void() : ::pamr::contract_violated("postcondition", #condition, __FILE__, __LINE__))

/// Costly checks: on in the presets `debug`, `asan` and `audit`.
#ifdef PAMR_AUDIT
#define PAMR_EXPECTS_AUDIT(condition) PAMR_EXPECTS(condition)
#define PAMR_ENSURES_AUDIT(condition) PAMR_ENSURES(condition)
#else
#define PAMR_EXPECTS_AUDIT(condition) static_cast<void>(0)
#define PAMR_ENSURES_AUDIT(condition) static_cast<void>(0)
#endif
