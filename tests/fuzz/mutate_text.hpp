// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "support/dice.hpp"

namespace pamr::fuzz {

/// Damages a text in its structure: numbers become others (of the text, next to them, or ones that readers trip over),
/// words others of its words, lines are left out, repeated or swapped, and marks of punctuation come and go. One to
/// three such changes.
void damage_text(std::string& text, test::Dice& dice);

}  // namespace pamr::fuzz
