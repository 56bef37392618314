# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DOUT=FILE.cpp "-DNAMES=a;b" "-DFILES=a.js;b.css" -P embed.cmake: texts of files as pamr::report::parts::NAME.
set(source "// Made by embed.cmake.\n#include \"report/page_parts.hpp\"\nnamespace pamr::report::parts {\n")
foreach(name file IN ZIP_LISTS NAMES FILES)
  file(READ "${file}" text)
  string(APPEND source "const std::string_view ${name} = R\"embedded(${text})embedded\";\n")
endforeach()
file(WRITE "${OUT}" "${source}}  // namespace pamr::report::parts\n")
