#pragma once
#include <span>
#include <string_view>

namespace palpate {

/// A file of the viewer, part of the program. Constant data; any thread.
struct ViewerFile {
  std::string_view path;  ///< below `/`: "index.html", "viewer.js", …
  std::string_view type;  ///< "text/html; charset=utf-8"
  std::string_view content;
};

/// The viewer's files; empty when the program was built without it. `index.html` is what `/` gives.
std::span<const ViewerFile> viewer_files();

/// Why there is no viewer, one sentence of plain text; empty when there is one.
std::string_view viewer_missing();

}  // namespace palpate
