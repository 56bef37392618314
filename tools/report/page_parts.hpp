// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

/// Files of the page, embedded by embed.cmake.
namespace pamr::report::parts {

extern const std::string_view page_html, report_css, charts_js, colors_js, details_js, page_js, sections_js, unpack_js,
    view_js;
extern const std::string_view three_js, uplot_js, uplot_css;  ///< of third parties, with their licenses

}  // namespace pamr::report::parts
