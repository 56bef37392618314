// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace pamr::dsmc {

/// The species that cases find by name: the text of gases.toml, with its sources, compiled in. Installations have the
/// file in share/pamr/species, to be read and copied from. Local.
std::string_view known_gases();

}  // namespace pamr::dsmc
