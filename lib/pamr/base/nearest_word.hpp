// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pamr {

/// Of `known` the word that `word` is most likely a misspelling of, for "did you mean ...?"; nothing where none is
/// near: more than one change of a letter (insert, delete, replace, swap neighbors) for three letters of the word.
/// Of equally near words the first. Local. Cost: the product of the lengths for each known word.
std::optional<std::string> nearest_word(std::string_view word, const std::vector<std::string>& known);

}  // namespace pamr
