// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/contract.hpp"

namespace pamr {

void contract_violated(const char* kind, const char* condition, const char* file, int line) {
  throw ContractViolation(std::string("broken ") + kind + ": " + condition + " (" + file + ":" + std::to_string(line) +
                          ")");
}

}  // namespace pamr
