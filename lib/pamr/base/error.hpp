// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace pamr {

/// Bad input: a file, an option or a mesh that PAMR cannot accept. The message says what was expected, what was found
/// and where. Code that throws it inside a collective section does so on every rank with the same text (`par::agree`).
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A promise between two pieces of PAMR was broken: a defect of the caller (`PAMR_EXPECTS`) or of the callee
/// (`PAMR_ENSURES`), never of the user's input.
class ContractViolation : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

}  // namespace pamr
